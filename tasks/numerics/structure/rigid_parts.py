"""Rigid parts of a body from the ways of its vertices (2014, Sec. 6.1 and 6.2; by elimination, not by growth)."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.decimation import decimated
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.elimination import Bar, Body, eliminated
from kinetree.tasks.numerics.structure.oversegmentation import cone_runs, grouped, patches
from kinetree.tasks.numerics.structure.part_labels import connected, relabelled
from kinetree.tasks.numerics.structure.part_motion import fit, misfit, residuals, unevenness
from kinetree.tasks.numerics.topology.extrema import extrema as tips
from kinetree.tasks.numerics.topology.geodesics import farthest_bases, mu


class RigidParts(NamedTuple):
    """Rigid parts and how they move; x(t) ≈ R q + t for a vertex q of the reference.

    label    : (vertex,) part that moves most like it
    rigid    : (vertex,) share of its motion that the part alone explains: 1 on bones, less where the surface blends
    R, t     : (frame, part, 3, 3) · (frame, part, xyz) mesh unit
    residual : (frame, part) root mean square over the part's clearly rigid vertices, mesh unit
    """

    label: Ints
    rigid: Floats
    R: Floats
    t: Floats
    residual: Floats


class RigidPartsSettings(NamedTuple):
    """Lengths are shares of the root of the reference's area, areas shares of it.

    rings   : in the longest distance from each leaf
    cut     : root mean square residual that makes a tenth of a cone's rings worth a run of their own
    patches : the whole surface is cut into
    trunk   : groups of patches to begin with outside the cones
    split   : growth of the mean squared residual, times area, from which on patches of one run or group stay apart
    smooth  : radius of the surroundings that decide with a vertex
    bar     : what a part must pass to stay
    most    : vertices; a larger surface is asked at so many, and the others go with the nearest of them
    slip    : the bar's own where every vertex was followed: nothing slides along the surface there
    """

    rings: int = 50
    cut: float = 0.002
    patches: int = 1000
    trunk: int = 16
    split: float = 1e-7
    smooth: float = 0.015
    bar: Bar = Bar()
    most: int = 14_000
    slip: float = 0.6


def rigid_parts(
    V: Floats,
    F: npt.NDArray[np.integer[Any]],
    x: Floats,
    trust: Floats | None = None,
    leaves: Ints | None = None,
    settings: RigidPartsSettings | None = None,
) -> RigidParts:
    """The rigid parts that the motion shows, as many as would be missed; one if nothing turns.

    V, F    : (vertex, xyz) reference, mesh unit · (face, corner); small components go with what is nearest
    x       : (frame, vertex, xyz) mesh unit
    trust   : (frame, vertex) how far each position is to be believed, 0 to 1; if not given every vertex was followed
    leaves  : (leaf,) vertices at the tips of the extremities; found on V, F if not given, and there may be none
    returns : PartsFound, parts numbered by their first vertex
    """
    chosen = settings or RigidPartsSettings()
    if trust is None:
        chosen = chosen._replace(bar=chosen.bar._replace(slip=chosen.slip))
    kept, body = _asked(V, F, chosen.most)
    nearest = _nearest(V, F, kept)
    surface = Surface.of(V[kept], body)
    tip = _tips(surface, body) if leaves is None else np.unique(nearest[leaves])
    size, centre, shift = float(np.sqrt(surface.area.sum())), surface.centre, x[:, kept].mean(axis=1, keepdims=True)
    X = np.ascontiguousarray((x[:, kept] - shift) / size, np.float64)
    weight = np.ones(X.shape[:2]) if trust is None else np.array(trust[:, kept], np.float64)
    found = _found(surface, body, (V[kept] - centre) / size, X, weight, tip, chosen)
    t = size * found.t + shift - found.R @ centre
    return RigidParts(found.label[nearest], found.rigid[nearest], found.R, t, size * found.residual)


def _asked(V: Floats, F: npt.NDArray[np.integer[Any]], most: int) -> tuple[Ints, Ints]:
    """(kept,) vertices of the largest component, of a coarser mesh on some of them if they are many · (face, corner)."""
    kept, faces, _ = largest_component(V, np.array(F, np.int32))
    if len(kept) <= most:
        return kept, faces
    some, coarse = decimated(V[kept], faces, most)
    whole, faces, _ = largest_component(V[kept[some]], coarse.astype(np.int32))
    return kept[some[whole]], faces


def _nearest(V: Floats, F: npt.NDArray[np.integer[Any]], kept: Ints) -> Ints:
    """(vertex,) which of the vertices kept lies nearest along the edges; straight, where no way leads to one."""
    number = np.full(len(V), -1)
    number[kept] = np.arange(len(kept))
    if len(kept) == len(V):
        return number
    start, ring = rings(np.array(F, np.int64), len(V))
    length = np.linalg.norm(V[np.repeat(np.arange(len(V)), np.diff(start))] - V[ring], axis=1)
    way = csr_array((np.maximum(length, 1e-300), ring, start), shape=(len(V), len(V)))
    source = dijkstra(way, indices=kept, return_predecessors=True, min_only=True)[2]
    bare = source < 0
    out = np.where(bare, -1, number[np.maximum(source, 0)])
    if bare.any():
        out[bare] = cKDTree(V[kept]).query(V[bare])[1]
    return out


def _tips(surface: Surface, F: Ints) -> Ints:
    bases = farthest_bases(surface)
    return tips(mu(bases.distance, bases.weight), F).vertex


def _found(
    surface: Surface, F: Ints, V: Floats, x: Floats, weight: Floats, leaves: Ints, chosen: RigidPartsSettings
) -> RigidParts:
    """Parts of one component; lengths in the root of its area, but for those of `surface`."""
    unit = float(np.sqrt(surface.area.sum()))
    body = Body(V, _normals(surface.position, F), F, x, weight, surface.area / unit**2, *rings(F, len(V)))
    patch = patches(surface, V, body.start, body.ring, chosen.patches)
    label = _many(surface, body, patch, leaves, chosen)
    steps = max(round((chosen.smooth * unit / surface.edge) ** 2), 1)
    label, R, t = _refitted(body, label, chosen.bar.floor)
    bar = chosen.bar
    for turn in range(4):
        if turn == 2:
            bar = _raised(chosen.bar, body, patch, label, R, t)
        if turn > 1:
            label, R, t = eliminated(body, bar, label, R, t)
        label = relabelled(V, x, weight, R, t, label, body.start, body.ring, steps)
        label, R, t = _refitted(body, label, chosen.bar.floor)
    e = misfit(V, x, weight, R, t, label)
    rigid = bar.removal_cost**2 / (bar.removal_cost**2 + 4 * e)
    return RigidParts(label, rigid, R, t, residuals(V, x, weight * body.area * rigid, R, t, label))


def _raised(bar: Bar, body: Body, patch: Ints, label: Ints, R: Floats, t: Floats) -> Bar:
    """The bar, raised where the body is soft, as in cloth, or badly aligned: by the median unevenness of its patches."""
    piece = np.unique(patch * (label.max() + 1) + label, return_inverse=True)[1].reshape(-1)
    stray = unevenness(body.V, body.x, body.area, piece, label, R, t)
    uneven = _median(stray, np.bincount(piece, body.area).astype(np.float64))
    quiet = _median(misfit(body.V, body.x, body.weight, R, t, label), body.area)
    return bar._replace(removal_cost=max(bar.removal_cost, bar.noise * uneven), quiet=quiet)


def _median(values: Floats, weight: Floats) -> float:
    order = np.argsort(values, kind="stable")
    share = np.cumsum(weight[order])
    return float(values[order[np.searchsorted(share, 0.5 * share[-1])]])


def _many(surface: Surface, body: Body, patch: Ints, leaves: Ints, chosen: RigidPartsSettings) -> Ints:
    """(vertex,) deliberately too many parts."""
    V, x, start, ring = body.V, body.x, body.start, body.ring
    mass = body.weight * body.area
    run = cone_runs(surface, V, x, mass, leaves, start, ring, chosen.rings, chosen.cut)
    trunk = grouped(V, x, mass, patch, np.where(run < 0, 0, -1), start, ring, chosen.trunk, np.inf)
    label = np.where(run < 0, run.max() + 1 + trunk, run)
    label = grouped(V, x, mass, patch, label, start, ring, 1, chosen.split * len(x))
    return connected(label, int(label.max()) + 1, start, ring)


def _refitted(body: Body, label: Ints, floor: float) -> tuple[Ints, Floats, Floats]:
    """Parts that have vertices, numbered by their first one, and their motions."""
    _, first, label = np.unique(label, return_index=True, return_inverse=True)
    label = np.argsort(np.argsort(first))[label.reshape(-1)]
    R, t = np.empty((len(body.x), len(first), 3, 3)), np.empty((len(body.x), len(first), 3))
    fit(body.V, body.x, body.weight, body.area, label, np.ones(len(first), np.bool_), False, len(label), floor, R, t)
    return label, R, t


def _normals(V: Floats, F: Ints) -> Floats:
    """(vertex, xyz) unit, area-weighted means of the faces around; 0 where they cancel."""
    n = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    N = np.stack([np.bincount(F.ravel(), np.repeat(n[:, k], 3), len(V)) for k in range(3)], axis=1)
    unit: Floats = N / np.maximum(np.linalg.norm(N, axis=1, keepdims=True), np.finfo(float).tiny)
    return unit
