"""The body's parts, its tree of joints, how far each joint turns and how much it is to be believed (2014, Fig. 15)."""

from typing import TYPE_CHECKING, Any

import numpy as np

from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.colours import KINDS, pale_part_colours
from kinetree.tasks.results.formats.rig import skinned
from kinetree.tasks.results.plots.drawing import COLOURS, LABEL_BOX, Fetch, blank, same_scale, surface, tall, view
from kinetree.tasks.results.plots.style import heading
from kinetree.tasks.results.plots.timeline import joint_labels, over_time

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


BONE = "#0a0a0a"
"""Black over a body, which stays so on a dark page."""


def skeleton(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Parts and skeleton on the aligned mesh, one view a frame; white where the surface is not rigid."""
    body = fetch("skeleton")
    bodies = [skinned(body, body.frames.index(frame)) for frame in frames]
    axis = view(bodies, up)
    figure, row = blank(3.4 * len(frames), tall([V @ axis for V in bodies], 3.4), len(frames))
    colour = part_colours(body)
    for axes, frame, V in zip(np.atleast_1d(row), frames, bodies, strict=True):
        surface(axes, V @ axis, body.faces, colour)
        bones(axes, body, body.positions[body.frames.index(frame)] @ axis)
        axes.set_title(f"frame {frame}", fontsize=9)
    same_scale(figure.axes)
    return figure


def tree(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """The tree of joints by name, from the root outwards: lengths of bones and range of turning."""
    body = fetch("skeleton")
    place, labels = _layout(body.parents), joint_labels(fetch, body.names)
    depth = place[:, 0].max() + 1
    figure, axes = blank(max(7.0, 2.1 * depth), max(2.5, 0.42 * (place[:, 1].max() + 2)))
    unit = f" {body.unit}" if body.unit else ""
    for j, parent in enumerate(body.parents):
        if parent >= 0:
            axes.plot(*zip(place[parent], place[j], strict=True), color="0.6", lw=1, zorder=1)
        axes.plot(*place[j], "o", color=KINDS[body.kinds[j]], ms=6, zorder=2)
        label = labels[j] + (f"\n{body.lengths[j]:.3g}{unit}" if parent >= 0 else "")
        label += f", {body.degrees[j]:.0f}°" if body.kinds[j] == "joint" else ""
        axes.annotate(label, place[j], xytext=(9, 0), textcoords="offset points", va="center", fontsize=7, bbox=LABEL_BOX)
    axes.set(xlim=(-0.3, depth + 0.2), ylim=(place[:, 1].max() + 0.7, -0.7))
    axes.set_axis_off()
    heading(axes, "Joints (orange), end effectors (blue): length of the bone to the parent, range of turning")
    return figure


def confidence(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """How far every joint is to be believed in every frame, and by what its place is uncertain."""
    body = fetch("skeleton")
    labels = joint_labels(fetch, body.names)
    inner = [j for j, kind in enumerate(body.kinds) if kind != "leaf"]
    figure, (axes, beside) = blank(10.0, max(2.5, 0.25 * len(inner) + 1.2), columns=2)
    edges = np.concatenate([[body.frames[0]], np.array(body.frames[1:]), [body.frames[-1] + 1]]) - 0.5
    rows = np.arange(len(inner) + 1) - 0.5
    picture = axes.pcolormesh(edges, rows, body.confidence[:, inner].T, vmin=0, vmax=1, cmap="cividis", rasterized=True)
    axes.set_ylim(len(inner) - 0.5, -0.5)
    bar = figure.colorbar(picture, ax=axes)
    bar.set_label("confidence", fontsize=8)
    axes.set(yticks=range(len(inner)), xlim=(body.frames[0] - 0.5, body.frames[-1] + 0.5))
    over_time(axes, body.frames, body.fps)
    axes.set_yticklabels([labels[j] for j in inner], fontsize=7)
    size = float(np.linalg.norm(np.ptp(body.vertices, axis=0)))
    beside.barh(range(len(inner)), body.drift[inner] / size * 100, color=COLOURS[0])
    beside.set(ylim=(len(inner) - 0.5, -0.5), yticks=range(len(inner)), xlabel="parts disagree by, % of the body's diagonal")
    beside.set_yticklabels([f"{body.degrees[j]:.0f}°" for j in inner], fontsize=7)
    beside.set_ylabel("range of turning")
    return figure


def part_colours(body: Skeleton) -> Floats:
    """(face, 4) pale colours of the parts, white where a face is not rigid or lies between two."""
    return label_colours(np.asarray(body.label), body.faces)


def label_colours(label: Ints, F: Ints, colours: Floats | None = None) -> Floats:
    """(face, 4) a pale colour for each label, white where a face has none or lies between two.

    label   : (vertex,) −1 for none
    F       : (face, corner)
    colours : (label + 1, rgb) as `pale_part_colours` gives them; None for those of these labels
    """
    rgb = pale_part_colours(label, F) if colours is None else colours
    corners = label[F]
    own = np.where((corners == corners[:, :1]).all(axis=1), corners[:, 0], -1)
    return np.concatenate([rgb[own], np.ones((len(own), 1))], axis=1)


def bones(axes: "Axes", body: Skeleton, X: Floats) -> None:
    """Bones and joints over a body, in the view's own axes; the root is a square, end effectors are small."""
    for j, parent in enumerate(body.parents):
        if parent >= 0:
            axes.plot(*X[[parent, j], :2].T, color=BONE, lw=1.4, zorder=3)
    shape: dict[str, Any] = {"root": ("s", 6), "joint": ("o", 5), "leaf": (".", 5)}
    for j, kind in enumerate(body.kinds):
        marker, size = shape[kind]
        axes.plot(*X[j, :2], marker, ms=size, color=KINDS[kind], mec="white", mew=0.4, zorder=4)


def _layout(parents: tuple[int, ...]) -> Floats:
    """(joint, 2) depth and row of every joint: leaves in rows of their own, parents amid their children."""
    children: list[list[int]] = [[] for _ in parents]
    depth = np.zeros(len(parents))
    for j, parent in enumerate(parents):
        if parent >= 0:
            children[parent].append(j)
            depth[j] = depth[parent] + 1
    row = np.full(len(parents), -1.0)
    free = 0
    waiting = [(j, False) for j, parent in enumerate(parents) if parent < 0][::-1]
    while waiting:
        j, done = waiting.pop()
        if not children[j]:
            row[j], free = free, free + 1
        elif done:
            row[j] = np.mean([row[c] for c in children[j]])
        else:
            waiting += [(j, True), *((c, False) for c in reversed(children[j]))]
    return np.stack([depth, row], axis=1)
