"""What the structure was found from, kept for people to look at: annuli, merge errors, the graph of parts, bones' lengths.

Nothing here decides anything; it follows what `structure` decided (2014, Figs. 7, 11 and 15).
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.rigid_moments import MOMENTS, moments, residual
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.joint_rotations import turning_range
from kinetree.tasks.numerics.structure.leaf_cones import cones
from kinetree.tasks.numerics.structure.optimal_runs import runs
from kinetree.tasks.numerics.structure.oversegmentation import LEAST
from kinetree.tasks.numerics.structure.part_tree import Carried, Surfaces, against, part_tree


class ConesTraced(NamedTuple):
    """Cones, ring by ring; a cone's rings end with the last that has vertices which no other cone has.

    ring  : (cone, vertex) ring of every vertex, 0 around the tip, −1 beyond the cone
    run   : (cone, ring) rigid run that the optimal cut puts each ring in, ascending from 0; −1 beyond the last ring
    merge : (cone, ring) what joining the rings on both sides of a ring's far border would leave unexplained, root mean
            square, share of the root of the area; NaN from the last ring on
    """

    ring: Ints
    run: Ints
    merge: Floats

    @property
    def own(self) -> Ints:
        """(cone, vertex) ring of every vertex that lies in this cone alone, −1 elsewhere."""
        return np.where((self.ring >= 0).sum(axis=0) == 1, self.ring, -1)


class PartsGraph(NamedTuple):
    """Parts that meet, and what speaks for a joint between them.

    pair    : (border, 2) parts, the smaller number first
    rest    : (border, xyz) the point they turn about best, mesh unit
    drift   : (border,) by what they disagree on where it goes, root mean square, mesh unit
    degrees : (border,) range of their turning against each other
    kept    : (border,) whether the spanning tree has it
    """

    pair: Ints
    rest: Floats
    drift: Floats
    degrees: Floats
    kept: Flags


def traced_cones(
    V: Floats, F: npt.NDArray[np.integer[Any]], x: Floats, trust: Floats | None, tips: Ints, count: int, cut: float
) -> ConesTraced:
    """The cones that parts are sought in, and how ill their rings go together.

    A border's merge error is √(Δ / m): Δ the growth of the rigid residual when the tenth of the rings before it and the
    tenth behind it become one, m the frames times a fifth of the rings' usual mass. Beyond `cut` two such tenths alone
    would be worth a cut, so that error and threshold are those of the optimal cut itself, as far as a tenth reaches.

    V, F  : (vertex, xyz) reference, mesh unit · (face, corner)
    x     : (frame, vertex, xyz) mesh unit
    trust : (frame, vertex) how far each position is to be believed; all of them if None
    tips  : (cone,) vertices around which cones are laid
    count : rings in the longest distance from each tip
    cut   : see `structure.beginning.cone_runs`, share of the root of the area
    """
    kept, body, _ = largest_component(V, np.array(F, np.int32))
    number = np.full(len(V), -1)
    number[kept] = np.arange(len(kept))
    rows = np.flatnonzero(number[tips] >= 0)
    blank = np.full((len(tips), len(V) + count), -1, np.int64)
    found = ConesTraced(blank[:, : len(V)], blank[:, len(V) :], np.full((len(tips), count), np.nan))
    if not len(rows):
        return found
    surface, at = Surface.of(V[kept], body), number[tips[rows]]
    distance = geodesic_distance(surface, at, exact=0.0)
    found.ring[np.ix_(rows, kept)] = cones(distance, surface.area, at, *rings(body, len(kept)), count)
    size = float(np.sqrt(surface.area.sum()))
    q = (V[kept] - surface.centre) / size
    y = np.ascontiguousarray((x[:, kept] - x[:, kept].mean(axis=1, keepdims=True)) / size, np.float64)
    weight = np.broadcast_to(surface.area, y.shape[:2]) * (1.0 if trust is None else trust[:, kept])
    for row, own in zip(rows, found.own[np.ix_(rows, kept)], strict=True):
        if own.max() >= 0:
            M = moments(q, y, weight, own, int(own.max()) + 1)
            run, merge = _cut(M, count, cut)
            found.run[row, : len(run)] = run
            found.merge[row, : len(merge)] = merge
    return found


def _cut(M: Floats, count: int, cut: float) -> tuple[Ints, Floats]:
    """(ring,) the run of every ring of a cone · (ring − 1,) merge errors, NaN beside a ring that has no vertices."""
    held: Floats = M[:, :, 0].mean(axis=1)
    mass = M.shape[1] * float(np.median(held)) * count / 5
    run = runs(M, mass * cut**2, LEAST)
    known = (held[1:] > 0.0) & (held[:-1] > 0.0) & (mass > 0.0)
    error = np.sqrt(growth(M, max(count // 10, LEAST)) / (mass or 1.0))
    return run, np.asarray(np.where(known, error, np.nan), np.float64)


def vertex_areas(V: Floats, F: npt.NDArray[np.integer[Any]]) -> Floats:
    """(vertex,) a third of the faces around, mesh unit²."""
    n = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    return np.asarray(np.bincount(F.ravel(), np.repeat(np.linalg.norm(n, axis=1) / 6, 3), len(V)), np.float64)


def most(ring: Ints, label: Ints, area: Floats, count: int) -> Ints:
    """(cone, ring) the label that most of a ring's area has, −1 where a ring is empty.

    ring, label : (cone, vertex) −1 beyond · (vertex,) 0 or more; area : (vertex,) mesh unit²
    """
    labels = int(label.max(initial=-1)) + 1
    out = np.full((len(ring), count), -1, np.int64)
    for k, r in enumerate(ring):
        inside = r >= 0
        held = np.bincount(r[inside] * labels + label[inside], area[inside], count * labels).reshape(count, labels)
        out[k] = np.where(held.any(axis=1), held.argmax(axis=1), -1)
    return out


def growth(M: Floats, reach: int) -> Floats:
    """(ring − 1,) by what the rigid residual grows when the rings before a border and those behind it become one.

    M     : (ring, frame, 17) sums of every ring; see `moments.MOMENTS`
    reach : rings on either side, fewer at the ends
    """
    up_to = np.concatenate([np.zeros((1, *M.shape[1:])), np.cumsum(M, axis=0)])
    border = np.arange(1, len(M))
    before = up_to[border] - up_to[np.maximum(border - reach, 0)]
    behind = up_to[np.minimum(border + reach, len(M))] - up_to[border]
    both, one, other = (
        np.array([residual(m) for m in side.reshape(-1, MOMENTS)]).reshape(side.shape[:2]).sum(axis=1)
        for side in (before + behind, before, behind)
    )
    grown: Floats = np.maximum(both - one - other, 0.0)
    return grown


def parts_graph(body: Surfaces, parts: Carried) -> PartsGraph:
    """All borders of the parts as they are before any is dropped, and the spanning tree of them."""
    found = part_tree(body, parts)
    pair = found.borders.pair
    kept = np.zeros(len(pair), np.bool_)
    kept[found.tree.border[1:]] = True
    degrees = np.array([turning_range(against(parts.R, int(a), int(b))) for a, b in pair], np.float64)
    return PartsGraph(pair, found.joints.rest, found.joints.drift, degrees, kept)


def survivors(V: Floats, area: Floats, parts: Carried, joints: Ints, R: Floats, t: Floats) -> Ints:
    """Which joint of the finished body carries each part: the one whose motion is nearest, no two parts on one joint.

    V, area : (vertex, xyz), (vertex,) mesh unit
    joints  : (carrier,) numbers of the joints that carry a rigid part, R, t : (frame, carrier, 3, 3), (frame, carrier, xyz)
    returns : (part,) joint, −1 for parts that were dropped
    """
    q = np.concatenate([V, np.ones((len(V), 1))], axis=1)
    count = parts.R.shape[1]
    square = np.zeros((count, 4, 4))
    for part in range(count):
        mine = parts.label == part
        square[part] = (q[mine] * area[mine, None]).T @ q[mine] / max(float(area[mine].sum()), np.finfo(float).tiny)
    apart = np.zeros((count, len(joints)))
    for f in range(len(R)):
        theirs = np.concatenate([R[f], t[f][..., None]], axis=2)
        D = np.concatenate([parts.R[f], parts.t[f][..., None]], axis=2)[:, None] - theirs[None]
        apart += np.einsum("pjxa,pab,pjxb->pj", D, square, D, optimize=True)
    out = np.full(count, -1, np.int64)
    part, carrier = linear_sum_assignment(apart)
    out[part] = joints[carrier]
    return out


def bone_lengths(rest: Floats, parents: Ints, part: Ints, R: Floats, t: Floats) -> Floats:
    """Length of every bone in every frame as the parts alone carry its ends, before lengths are held.

    rest    : (joint, xyz) mesh unit, parents : (joint,) −1 for the root
    part    : (joint,) rigid part that turns about each joint, −1 for the end of a bone, which goes with its parent's
    R, t    : (frame, part, 3, 3), (frame, part, xyz)
    returns : (frame, joint) from each joint to its parent, mesh unit; 0 for the root. A joint is where its two parts
              have it in the mean.
    """
    above = np.where(parents < 0, part, part[np.maximum(parents, 0)])
    own = np.where(part < 0, above, part)
    carried = [np.einsum("tjxy,jy->tjx", R[:, p], rest) + t[:, p] for p in (own, above)]
    X = (carried[0] + carried[1]) / 2
    length: Floats = np.linalg.norm(X - X[:, np.maximum(parents, 0)], axis=2)
    return np.where(parents < 0, 0.0, length)
