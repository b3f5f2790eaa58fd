"""Rigid parts of a body from the trajectories of its vertices (2014, Sec. 6.1 and 6.2; by elimination, not by growth: ours)."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.decimation import decimated
from kinetree.tasks.numerics.geometry.neighbours import edge_lengths, ring_edges, rings
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.elimination import EliminationSettings, NormalisedBody, eliminated
from kinetree.tasks.numerics.structure.halved_parts import halved
from kinetree.tasks.numerics.structure.oversegmentation import ConeRuns, OversegmentationSettings, cone_runs, grouped, patches
from kinetree.tasks.numerics.structure.part_labels import connected, relabelled
from kinetree.tasks.numerics.structure.part_motion import fit, misfit, residuals, rigid_share, unevenness
from kinetree.tasks.numerics.structure.parted_limbs import parted
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.topology.extrema import extrema
from kinetree.tasks.numerics.topology.geodesics import farthest_bases, mu

LABEL_ROUNDS = 2
"""Rounds of labels and motions before the elimination; more of them found no more joints."""
ELIMINATIONS = 2
"""Eliminations, each followed by a round of labels and motions; not recorded."""


class Cut(NamedTuple):
    """The cut into too many parts that the elimination began with, and what the elimination removed.

    cone, ring : (vertex,) cone in which a vertex counts, or `NO_CONE` or `SHARED` of `oversegmentation` · its ring there, or −1
    tip        : (cone,) vertex around which each cone lies
    run, merge : (cone, ring) see `oversegmentation.ConeRuns`; lengths in the root of the area
    initial    : (vertex,) part of the first cut
    removed    : (removal,) parts of the first cut in the order in which they were eliminated
    cost       : (removal,) what removing each cost, root of the area
    merge_threshold, cost_threshold : merge error above which tenths of a cone are cut apart · cost from which on parts stay
    origin     : (part,) which part of the first cut each rigid part has become; those of one were cut apart, see
                 `halved_parts`, `parted_limbs`
    """

    cone: Ints
    ring: Ints
    tip: Ints
    run: Ints
    merge: Floats
    initial: Ints
    removed: Ints
    cost: Floats
    merge_threshold: float
    cost_threshold: float
    origin: Ints


class RigidParts(NamedTuple):
    """Rigid parts and how they move; x(t) ≈ R q + t for a vertex q of the reference.

    label    : (vertex,) part that moves most like it
    rigid    : (vertex,) share of its motion that the part alone explains: 1 on bones, less where the surface blends
    R, t     : (frame, part, 3, 3) · (frame, part, xyz) mesh unit
    residual : (frame, part) root mean square over the part's clearly rigid vertices, mesh unit
    cut      : what they were made from
    """

    label: Ints
    rigid: Floats
    R: Floats
    t: Floats
    residual: Floats
    cut: Cut


class RigidPartsSettings(NamedTuple):
    """How parts are cut, labelled and eliminated; lengths are shares of the root of the area, areas shares of it."""

    first_cut: OversegmentationSettings
    """Of the cut into too many parts."""
    elimination: EliminationSettings
    """Of the elimination."""
    smoothing: float = 0.015
    """Radius of the surroundings whose residual decides with a vertex. Not recorded."""
    most_vertices: int = 14_000
    """A larger surface is cut at a sample of so many vertices, and the others go with the nearest of them. Chosen for time: a
    body of 42,000 vertices takes a third of it."""
    followed_slip: float = 0.6
    """`EliminationSettings.slip` where every vertex was followed, so that nothing slides along the surface. Chosen on generated
    humans: at 0.3 necks and spines were lost (90.6 % of joints found)."""


def rigid_parts(
    V: Floats,
    F: npt.NDArray[np.integer[Any]],
    x: Floats,
    confidence: Floats | None = None,
    leaves: Ints | None = None,
    *,
    settings: RigidPartsSettings,
    takes: Sequence[slice] | None = None,
) -> RigidParts:
    """The rigid parts that the motion shows, each of which costs enough to remove; one if nothing turns.

    V, F       : (vertex, xyz) reference, mesh unit · (face, corner); small components go with what is nearest
    x          : (frame, vertex, xyz) mesh unit
    confidence : (frame, vertex) 0 to 1; if not given every vertex was followed
    leaves     : (leaf,) vertices at the tips of the limbs; found on V, F if not given, and there may be none
    takes      : positions of the frames of each take; None takes all as one
    returns    : parts numbered by their first vertex; `cut` was made at a sample of a large surface's vertices, and every other
                 vertex has the values of the nearest one in the sample
    """
    chosen, limits = settings, settings.elimination
    if confidence is None:
        limits = limits._replace(slip=chosen.followed_slip)
    sample, faces = _sampled(V, F, chosen.most_vertices)
    nearest = _nearest(V, F, sample)
    surface = Surface.of(V[sample], faces)
    tip = _tips(surface, faces) if leaves is None else np.unique(nearest[leaves])
    size, centre, shift = float(np.sqrt(surface.area.sum())), surface.centre, x[:, sample].mean(axis=1, keepdims=True)
    X = np.ascontiguousarray((x[:, sample] - shift) / size, np.float64)
    weight = np.ones(X.shape[:2]) if confidence is None else np.array(confidence[:, sample], np.float64)
    spans = score_spans(len(x), takes)
    parts = _normalised_parts(surface, faces, (V[sample] - centre) / size, X, weight, tip, spans, chosen, limits)
    t = size * parts.t + shift - parts.R @ centre
    cut = parts.cut._replace(
        tip=sample[parts.cut.tip], **{name: getattr(parts.cut, name)[nearest] for name in ("cone", "ring", "initial")}
    )
    return RigidParts(parts.label[nearest], parts.rigid[nearest], parts.R, t, size * parts.residual, cut)


def _sampled(V: Floats, F: npt.NDArray[np.integer[Any]], most: int) -> tuple[Ints, Ints]:
    """(sample,) vertices of the largest component, or of a coarser mesh on some of them if they are many · (face, corner)."""
    component, faces, _ = largest_component(V, np.array(F, np.int32))
    if len(component) <= most:
        return component, faces
    sample, coarse = decimated(V[component], faces, most)
    whole, faces, _ = largest_component(V[component[sample]], coarse.astype(np.int32))
    return component[sample[whole]], faces


def _nearest(V: Floats, F: npt.NDArray[np.integer[Any]], sample: Ints) -> Ints:
    """(vertex,) which of the sample lies nearest along the edges; the nearest in space where no path leads to one."""
    number = np.full(len(V), -1)
    number[sample] = np.arange(len(sample))
    if len(sample) == len(V):
        return number
    start, ring = rings(np.array(F, np.int64), len(V))
    source = dijkstra(edge_lengths(V, ring_edges(start, ring)), indices=sample, return_predecessors=True, min_only=True)[2]
    unreached = source < 0
    out = np.where(unreached, -1, number[np.maximum(source, 0)])
    if unreached.any():
        out[unreached] = cKDTree(V[sample]).query(V[unreached])[1]
    return out


def _tips(surface: Surface, F: Ints) -> Ints:
    """(extremum,) vertices at the local maxima of μ."""
    bases = farthest_bases(surface)
    return extrema(mu(bases.distance, bases.weight), F).vertex


def _normalised_parts(
    surface: Surface,
    F: Ints,
    V: Floats,
    x: Floats,
    weight: Floats,
    leaves: Ints,
    spans: Ints,
    chosen: RigidPartsSettings,
    limits: EliminationSettings,
) -> RigidParts:
    """Parts of one component; lengths in the root of its area, but for those of `surface`."""
    unit = float(np.sqrt(surface.area.sum()))
    N, area = vertex_normals(surface.position, F), surface.area / unit**2
    body = NormalisedBody(V, N, F, x, weight, area, *rings(F, len(V)), spans)
    first = chosen.first_cut
    patch = patches(surface, V, body.start, body.ring, first.patches)
    cones, initial = _first_cut(surface, body, patch, leaves, first)
    steps = max(round((chosen.smoothing * unit / surface.edge) ** 2), 1)
    used, label, R, t = _refitted(body, initial, limits.floor)
    initial, origin = label, np.arange(len(used))
    removed, cost = [], []
    for turn in range(LABEL_ROUNDS + ELIMINATIONS):
        if turn == LABEL_ROUNDS:
            limits = _raised(limits, body, patch, label, R, t)
        if turn >= LABEL_ROUNDS:
            found = eliminated(body, label, R, t, limits)
            label, R, t = found.label, found.R, found.t
            removed.append(origin[found.removed])
            cost.append(found.cost)
        label = relabelled(V, x, weight, R, t, label, body.start, body.ring, steps)
        used, label, R, t = _refitted(body, label, limits.floor)
        origin = origin[used]
    label, R, t, whole = halved(body, patch, label, R, t, limits, steps)
    label, limbs = parted(body, label, R, t, limits.removal_cost)
    if len(limbs) > len(origin):
        used, label, R, t = _refitted(body, label, limits.floor)
        origin = origin[whole][limbs][used]
    rigid = rigid_share(misfit(V, x, weight, R, t, label), limits.removal_cost)
    cut = Cut(
        cones.cone, cones.ring, leaves, cones.run, cones.merge, initial, np.concatenate(removed), np.concatenate(cost),
        first.cut, limits.removal_cost, origin,
    )  # fmt: skip
    return RigidParts(label, rigid, R, t, residuals(V, x, weight * body.area * rigid, R, t, label), cut)


def _raised(
    limits: EliminationSettings, body: NormalisedBody, patch: Ints, label: Ints, R: Floats, t: Floats
) -> EliminationSettings:
    """Limits raised where the body is soft, as in cloth, or badly aligned: by the median unevenness of its patches."""
    piece = np.unique(patch * (label.max() + 1) + label, return_inverse=True)[1].reshape(-1)
    strays = unevenness(body.V, body.x, body.area, piece, label, R, t)
    uneven = _median(strays, np.bincount(piece, body.area).astype(np.float64))
    noise = _median(misfit(body.V, body.x, body.weight, R, t, label), body.area)
    return limits._replace(removal_cost=max(limits.removal_cost, limits.noise * uneven), noise_square=noise)


def _median(values: Floats, weight: Floats) -> float:
    """The weighted median."""
    order = np.argsort(values, kind="stable")
    share = np.cumsum(weight[order])
    return float(values[order[np.searchsorted(share, 0.5 * share[-1])]])


def _first_cut(
    surface: Surface, body: NormalisedBody, patch: Ints, leaves: Ints, chosen: OversegmentationSettings
) -> tuple[ConeRuns, Ints]:
    """The cones' runs · (vertex,) deliberately too many parts."""
    V, x, start, ring = body.V, body.x, body.start, body.ring
    mass = body.weight * body.area
    cones = cone_runs(surface, V, x, mass, leaves, start, ring, chosen)
    outside = cones.label < 0
    trunk = grouped(V, x, mass, patch, np.where(outside, 0, -1), start, ring, chosen.trunk_groups, np.inf)
    label = np.where(outside, cones.label.max() + 1 + trunk, cones.label)
    label = grouped(V, x, mass, patch, label, start, ring, 1, chosen.split * len(x))
    return cones, connected(label, int(label.max()) + 1, start, ring)


def _refitted(body: NormalisedBody, label: Ints, floor: float) -> tuple[Ints, Ints, Floats, Floats]:
    """(part,) parts that have vertices, in the order of their first vertex · (vertex,) labels by that order · their motions."""
    used, first, label = np.unique(label, return_index=True, return_inverse=True)
    label = np.argsort(np.argsort(first))[label.reshape(-1)]
    R, t = np.empty((len(body.x), len(first), 3, 3)), np.empty((len(body.x), len(first), 3))
    fit(body.V, body.x, body.weight, body.area, label, np.ones(len(first), np.bool_), False, len(label), floor, R, t)
    return used[np.argsort(first)], label, R, t
