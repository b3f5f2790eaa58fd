"""How joints were found: cones, merge errors, elimination, graph of parts, lengths of bones (2014, Figs. 7, 11 and 15)."""

from itertools import pairwise
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import to_rgb

from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.results.majority import centroids, labels_of_rings
from kinetree.tasks.results.formats.colours import pale_part_colours
from kinetree.tasks.results.plots.drawing import COLOURS, LABEL_BOX, Fetch, blank, graded, surface, view, words
from kinetree.tasks.results.plots.structure import bones, part_colours
from kinetree.tasks.results.plots.style import heading
from kinetree.tasks.results.plots.timeline import joint_labels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NO_CONES = "no cones: no leaf is seen on the reference mesh"
REASONS = {
    "flesh": "flesh",
    "still": "turns too little",
    "sliding": "slides",
    "unevident": "not shown by the frames",
    "unpaired": "not in the mirrored limb",
    "alone": "joint of this cut alone",
    "midway": "one joint for two",
    "smeared": "smeared; the frames show another",
}
"""Why parts were dropped, in words for people."""
TITLE = 60
"""Characters of a line of a title, at most: two pictures stand side by side."""


def cones(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Every cone in a colour of its own, its annuli in turn lighter and darker, from both sides.

    Pale where several cones lie and none has the vertex, dark where there is none.
    """
    reference, parts = fetch("reference"), fetch("rigid_parts")
    V, axis = reference.vertices, view([reference.vertices], up)
    figure, row = blank(8.0, 4.8, 2)
    colour = _ring_colours(parts, reference.faces)
    for axes, turn, side in zip(row, (axis, axis * [-1, 1, -1]), ("one side", "the other"), strict=True):
        X = V @ turn
        surface(axes, X, reference.faces, colour)
        for k, tip in enumerate(parts.tip):
            axes.plot(*X[tip, :2], "o", color="white", mec="black", mew=1.0, ms=6, zorder=4)
            axes.annotate(f"{k}", X[tip, :2], xytext=(5, 5), textcoords="offset points", fontsize=8, bbox=LABEL_BOX)
        axes.set_title(side if len(parts.tip) else NO_CONES, fontsize=9)
    return figure


def merging(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Merge error along each cone from its tip inwards, its threshold, the first cut, and the joints' parts at the end."""
    skeleton, parts = fetch("skeleton"), fetch("rigid_parts")
    count, labels = len(parts.tip), joint_labels(fetch, skeleton.names)
    shades = pale_part_colours(skeleton.label, skeleton.faces)
    if not count:
        return words(NO_CONES)
    area = surface_areas(skeleton.vertices, skeleton.faces)
    joint = labels_of_rings(parts.cone, parts.ring, skeleton.influence[:, 0], area, parts.run.shape)
    columns = min(count, 3)
    rows = -(-count // columns)
    figure, grid = blank(3.6 * columns, 2.3 * rows + 0.6, columns, rows)
    panels = np.atleast_1d(grid).ravel()
    for axes in panels[count:]:
        axes.remove()
    highest = 100 * max(float(np.nanmax(parts.merge, initial=0.0)), 2 * parts.merge_threshold)
    last = int(np.flatnonzero((parts.run >= 0).any(axis=0)).max(initial=0))
    for k, axes in enumerate(panels[:count]):
        _merged(axes, labels, shades, parts, joint[k], k)
        axes.set(xlim=(0, last + 1), ylim=(0, 1.3 * highest))
        axes.set_title(f"cone {k}", fontsize=9, pad=3)
    figure.supxlabel("annulus, from the tip inwards", fontsize=9)
    figure.supylabel("merge error, % of the root of the area", fontsize=9)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=4, fontsize=8, frameon=False)
    return figure


def elimination(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Left, all parts of the first cut; middle, the parts that the elimination left; right, what removing each one cost."""
    reference, parts = fetch("reference"), fetch("rigid_parts")
    axis = view([reference.vertices], up)
    figure, (before, after, curve) = blank(11.0, 4.6, 3)
    for axes, label, of in ((before, parts.initial, None), (after, parts.label, parts.origin)):
        surface(axes, reference.vertices @ axis, reference.faces, _part_colours(label, reference.faces, of))
    before.set_title(f"first cut: {int(parts.initial.max()) + 1} parts", fontsize=9)
    after.set_title(f"{len(parts.removed)} removed, {len(parts.origin)} parts at the end", fontsize=9)
    number = np.arange(1, len(parts.cost) + 1)
    curve.plot(number, 100 * parts.cost, ".-", color=COLOURS[0], lw=1.2, ms=4, label="removal cost")
    curve.axhline(100 * parts.cost_threshold, color=COLOURS[1], lw=1.0, ls="--", label="threshold")
    curve.set(xlabel="parts removed", ylim=(0, 125 * max(parts.cost_threshold, float(parts.cost.max(initial=0.0)))))
    curve.set_ylabel("motion left unexplained, % of the root of the area", fontsize=8)
    curve.tick_params(labelsize=7)
    curve.legend(fontsize=8, frameon=False)
    return figure


def structure(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Left, all parts that meet, by the drift of their joint; right, the tree at the end."""
    skeleton, tree = fetch("skeleton"), fetch("kinematic_tree")
    axis = view([skeleton.vertices], up)
    figure, (before, after) = blank(10.4, 5.4, 2)
    pale = np.full((len(skeleton.faces), 4), 0.93)
    for axes, colour in ((before, pale), (after, part_colours(skeleton))):
        surface(axes, skeleton.vertices @ axis, skeleton.faces, colour)
    drift = 100 * tree.border_drift / float(np.linalg.norm(np.ptp(skeleton.vertices, axis=0)))
    shade = graded(float(drift.max(initial=1e-3)))
    area = surface_areas(skeleton.vertices, skeleton.faces)
    middle = centroids(skeleton.vertices, tree.part, area, len(tree.joint_of_part))
    _graph(before, tree, middle @ axis, tree.centre @ axis, shade.to_rgba(drift))
    bar = figure.colorbar(shade, ax=before, shrink=0.7, location="left", pad=0.0)
    bar.set_label("drift of the joint between two parts, % of the body's diagonal", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    counts = f"{len(tree.joint_of_part)} parts, {len(tree.pair)} borders; dotted: not in the spanning tree"
    heading(before, counts + _dropped(tree))
    bones(after, skeleton, skeleton.rest @ axis)
    lost = (tree.centre @ axis)[_lost(tree)]
    after.plot(*lost[:, :2].T, "x", color="black", ms=7, mew=1.8, zorder=6)
    joints = skeleton.kinds.count("joint")
    cut = "" if tree.cut_frame is None else f"\nparts of the cut in frame {tree.cut_frame}"
    heading(after, f"{joints} joints left; crossed: {len(lost)} borders of dropped parts or outside the tree{cut}")
    return figure


def lengths(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """How much every bone's length varies over the sequence as the parts alone carry its ends; held lengths vary by 0."""
    skeleton, tree = fetch("skeleton"), fetch("kinematic_tree")
    row = [j for j, parent in enumerate(skeleton.parents) if parent >= 0]
    if not row:
        return words("no bones: the body is one rigid part")
    figure, axes = blank(7.0, max(2.2, 0.2 * len(row) + 1.3))
    colour = [COLOURS[0] if skeleton.kinds[j] == "leaf" else COLOURS[1] for j in row]
    variation = tree.length_variation
    axes.barh(range(len(row)), variation[row], color=colour)
    unit = f" {skeleton.unit}" if skeleton.unit else ""
    for place, j in enumerate(row):
        text = f" {tree.free_length[j]:.3g} ± {tree.free_deviation[j]:.2g}{unit}"
        axes.annotate(text, (variation[j], place), va="center", fontsize=6.5)
    axes.set(ylim=(len(row) - 0.4, -0.6), yticks=range(len(row)), xlim=(0, 1.35 * max(float(variation.max()), 1e-6)))
    labels = joint_labels(fetch, skeleton.names)
    axes.set_yticklabels([labels[j] for j in row], fontsize=7)
    axes.tick_params(axis="x", labelsize=7)
    heading(axes, "Bones to joints (orange) and to end effectors (blue): mean length and its deviation")
    axes.set_xlabel("standard deviation of the bone's length before it is held, % of its mean; 0 after", fontsize=8)
    return figure


def _ring_colours(parts: RigidParts, F: Ints) -> Floats:
    """(face, 4) colour of the cone that a face is in, in turn lighter and darker by annulus."""
    cone, ring = parts.cone[F], parts.ring[F]
    colour: Floats = np.ones((len(F), 4))
    colour[:, :3] = np.where((cone == -2).any(axis=1), 0.88, 0.45)[:, None]
    for k in range(len(parts.tip)):
        inside = (cone == k).all(axis=1)
        light = 0.1 + 0.55 * (ring[inside].min(axis=1, initial=np.iinfo(np.int32).max) % 2)[:, None]
        colour[inside, :3] = (1 - light) * np.array(to_rgb(COLOURS[k % 6])) + light
    return colour


def _part_colours(label: Ints, F: Ints, origin: Ints | None) -> Floats:
    """(face, 4) colours of parts, of rigid parts those of the parts of the first cut that they grew from; dark borders."""
    part = label[F]
    own = part[:, 0] if origin is None else origin[part[:, 0]]
    palette = np.array([to_rgb(c) for c in COLOURS[:6]])
    colour: Floats = np.ones((len(F), 4))
    light = 0.35 + 0.3 * (own // 6 % 2)[:, None]
    colour[:, :3] = (1 - light) * palette[own % 6] + light
    colour[(part != part[:, :1]).any(axis=1), :3] = 0.2
    return colour


def _merged(axes: "Axes", names: tuple[str, ...], shades: Floats, parts: RigidParts, joint: Ints, k: int) -> None:
    """One cone: the curve, the threshold, first cuts as ticks below, joints' parts as bands."""
    rings = int((parts.run[k] >= 0).sum())
    part, run = joint[:rings], parts.run[k, :rings]
    edges = [0, *(np.flatnonzero(np.diff(part)) + 1).tolist(), rings]
    word: Any = {"transform": _over(axes), "ha": "center", "va": "top", "fontsize": 6, "rotation": 90}
    for a, b in pairwise(edges):
        if b > a and part[a] >= 0:
            axes.axvspan(a, b, color=shades[min(int(part[a]), len(shades) - 1)], alpha=0.7, lw=0)
            if b - a >= 3:
                axes.text((a + b) / 2, 0.97, names[int(part[a])], **word)
    cut = np.flatnonzero(np.diff(run)) + 1
    axes.vlines(edges[1:-1], 0, 1, transform=_over(axes), color="black", lw=0.8, label="border of parts")
    axes.vlines(cut, 0, 0.1, transform=_over(axes), color=COLOURS[3], lw=1.2, label="first cut")
    axes.plot(np.arange(1, rings + 1), 100 * parts.merge[k, :rings], color=COLOURS[0], lw=1.4, label="merge error")
    axes.axhline(100 * parts.merge_threshold, color=COLOURS[1], lw=1.0, ls="--", label="threshold")
    axes.tick_params(labelsize=7)


def _over(axes: "Axes") -> Any:
    """Across in data, up in shares of the axes."""
    return axes.get_xaxis_transform()


def _lost(tree: KinematicTree) -> Any:
    """(border,) whether a border is no joint at the end: not in the spanning tree, or of a part that was dropped."""
    dropped = tree.joint_of_part < 0
    return ~tree.in_tree | dropped[tree.pair].any(axis=1) if len(tree.pair) else np.zeros(0, np.bool_)


def _dropped(tree: KinematicTree) -> str:
    """How many parts were dropped for which reason, as further lines of a title."""
    reasons = [reason for _, reason in tree.dropped]
    counted = [f"{reasons.count(reason)} {words}" for reason, words in REASONS.items() if reason in reasons]
    return "\n" + fill(f"crossed: {len(reasons)} dropped ({', '.join(counted)})", TITLE) if counted else ""


def _graph(axes: "Axes", tree: KinematicTree, middle: Floats, centre: Floats, colour: Floats) -> None:
    """Parts as squares, crossed where they were dropped; borders as lines over their joints, dotted outside the tree."""
    for row, (a, b) in enumerate(tree.pair):
        line = np.stack([middle[a], centre[row], middle[b]])
        axes.plot(*line[:, :2].T, "-" if tree.in_tree[row] else ":", color=colour[row], lw=2.2, zorder=3)
        axes.plot(*centre[row, :2], "o", color=colour[row], mec="white", mew=0.4, ms=5, zorder=4)
    dropped = tree.joint_of_part < 0
    axes.plot(*middle[~dropped, :2].T, "s", color="black", ms=4, zorder=5)
    axes.plot(*middle[dropped, :2].T, "X", color=COLOURS[1], mec="white", mew=0.5, ms=9, zorder=5)
