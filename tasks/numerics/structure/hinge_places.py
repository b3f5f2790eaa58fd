"""Where along a limb the frames' own surfaces bend it (ours).

An alignment smears a bend, so that the border between two parts may lie beside it, in all cuts alike. Parts that are cut
there and laid on the surfaces confirm a joint that is wrong. Here border and joint move together: the two parts are laid as
one piece with a hinge, at several places along the limb, and every point goes with the part on its side of the hinge. The
joint goes to the place that leaves least, if halves of the frames agree on it, and two shapes of the border: a plane across the
limb, and the line that was cut.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFitSettings, PiecePose, piece_fit, placed_piece

FREE = PieceFitSettings(anchor=0.0)
"""The two parts lie on the surface by themselves; the rest of the body does not hold them."""


class HingePlacesSettings(NamedTuple):
    """Which joints move, and how far; lengths are in radii of the border.

    `agree`, `length` and `straight` were chosen on wave and on generated humans, quadrupeds and random trees of seeds 0 and 2.
    """

    agree: float = 0.5
    """Distance between the places of two halves of the frames, and between those of both shapes of the border, share of the way
    that the joint goes, at most. From 0.25 to 0.7 those bodies gain alike."""
    length: float = 1.25
    """Length of the bones on both sides of a joint, at least: a shorter part is flesh as much as bone. From 1 to 1.5 those gain
    alike, at 2 less."""
    straight: float = 0.4
    """Cosine of the angle between these bones in the reference, at least: at an ankle no direction is along the limb. From 0.4
    to 0.7 those gain alike."""
    laid: float = 0.8
    """Both limits where joints are laid, share of what they are where joints move: other cuts put the joints elsewhere."""
    reach: float = 2.0
    """Places lie as far as this on either side of the joint. At 1 and 1.5 those gain alike."""
    step: float = 0.5
    """From one place to the next. Not varied."""
    near: float = 4.0
    """Distance from the joint within which points may change sides. Not varied."""
    points: int = 250
    """Points of both parts, about; for time."""
    least_points: int = 8
    """Points on either side of a hinge, at least. Not varied."""
    rigid_weight: float = 0.75
    """Skinning weight of both parts together from which on a vertex is laid. Not varied."""

    @property
    def places(self) -> Floats:
        """(place,) along the limb, in radii; the one amid them is the joint."""
        count = round(self.reach / self.step)
        return np.asarray(self.step * np.arange(-count, count + 1), np.float64)


class HingeCosts(NamedTuple):
    """What two parts leave of the frames' surfaces with a hinge at each place.

    joint  : (hinge,) in the tree's order, ascending
    end    : (hinge, xyz) where the bone beyond the joint ends, mesh unit
    square : (laid, hinge, border shape, place) mean squared distance, mesh unit²
    """

    joint: Ints
    end: Floats
    square: Floats


class HingedLimb(NamedTuple):
    """The two parts at a joint, and on which side of the hinge their points lie.

    joint, end  : see `HingeCosts`
    V, N        : (point, xyz) mesh unit · (point, xyz) unit normals
    mass        : (point,) weight of each
    hinge       : (place, xyz) mesh unit
    far         : (border shape, place, point) whether a point lies beyond the hinge
    """

    joint: int
    end: Floats
    V: Floats
    N: Floats
    mass: Floats
    hinge: Floats
    far: Flags

    def piece(self, shape: int, place: int) -> Piece:
        """Both parts, with the hinge at a place and a shape of the border there."""
        at = self.hinge[place]
        return Piece(self.V, self.N, self.mass, self.far[shape, place], at, at)


def hinged_limbs(
    V: Floats, F: Ints, area: Floats, tree: FirstTree, settings: HingePlacesSettings | None = None
) -> list[HingedLimb]:
    """The joints whose bones are nearly long and straight enough, with the points of their parts.

    V, F, area : (vertex, xyz) reference, mesh unit · (face, corner) · (vertex,) mesh unit²
    """
    chosen, N, limbs = settings or HingePlacesSettings(), smoothed_normals(V, F), []
    edge = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    nearly = chosen._replace(length=chosen.laid * chosen.length, straight=chosen.laid * chosen.straight)
    for joint in sorted({*tree.label.tolist()} - {0}):
        end = _end(V, tree, joint)
        axis = limb_axis(tree, tree.rest, joint, end, nearly)
        if axis is not None:
            limb = _limb(V, N, area, edge, tree, joint, end, axis, chosen)
            if _both_sides(limb.far[:, len(limb.hinge) // 2], chosen.least_points).all():
                limbs.append(limb)
    return limbs


def hinge_costs(
    V: Floats, F: Ints, area: Floats, tree: FirstTree, surfaces: Mapping[int, Target],
    settings: HingePlacesSettings | None = None,
) -> HingeCosts:  # fmt: skip
    """Lays the parts at every joint of `hinged_limbs` on surfaces, with a hinge at each place.

    surfaces : by place among the frames, prepared surfaces
    """
    chosen, limbs = settings or HingePlacesSettings(), hinged_limbs(V, F, area, tree, settings)
    shape = (len(surfaces), len(limbs), 2, len(chosen.places))
    square = [[_left(limb, tree, f, target, chosen.least_points) for limb in limbs] for f, target in surfaces.items()]
    return HingeCosts(
        np.array([limb.joint for limb in limbs], np.int64),
        np.array([limb.end for limb in limbs]).reshape(-1, 3),
        np.array(square, np.float64).reshape(shape),
    )


def hinge_shifts(
    tree: FirstTree, costs: HingeCosts, rest: Floats, seen: Floats, settings: HingePlacesSettings | None = None
) -> Floats:
    """(part, xyz) way from joints to where the surfaces bend their limbs, mesh unit; 0 where these do not agree.

    rest : (part, xyz) the joints in the reference, mesh unit
    seen : (laid, part) share of its surface that is certain, 0 to 1
    """
    chosen, shifts = settings or HingePlacesSettings(), np.zeros_like(rest)
    anywhere = chosen._replace(length=0.0, straight=-np.inf)
    for k, (joint, end) in enumerate(zip(costs.joint.tolist(), costs.end, strict=True)):
        axis = limb_axis(tree, tree.rest, joint, end, anywhere)
        if axis is None or limb_axis(tree, rest, joint, end, chosen) is None:
            continue
        share = np.minimum(seen[:, joint], seen[:, tree.parents[joint]]) + 1e-3
        along = chosen.places * tree.radius[joint] - (rest[joint] - tree.rest[joint]) @ axis
        ways = np.array([_ways(along, share[:, None] * costs.square[:, k, shape]) for shape in range(2)])
        shifts[joint] = _agreed(ways, chosen.agree) * axis
    return shifts


def limb_axis(tree: FirstTree, rest: Floats, joint: int, end: Floats, settings: HingePlacesSettings) -> Floats | None:
    """(xyz,) amid the directions of the bones that meet at a joint; None where they are too short or too bent.

    rest : (part, xyz) the joints in the reference, mesh unit
    end  : (xyz,) see `HingeCosts`; where parts hang on the one beyond the joint, their joints count instead
    """
    below = np.flatnonzero(tree.parents == joint)
    end = rest[below].mean(axis=0) if len(below) else end
    bones = np.stack([rest[joint] - rest[tree.parents[joint]], end - rest[joint]])
    length = np.linalg.norm(bones, axis=1)
    if length.min() < settings.length * tree.radius[joint] or length.min() <= 0.0:
        return None
    one, other = bones / length[:, None]
    amid = np.linalg.norm(one + other)
    return None if one @ other < settings.straight or amid <= 0.0 else np.asarray((one + other) / amid)


def _agreed(ways: Floats, agree: float) -> float:
    """The way that a joint goes, 0 where both shapes of the border or halves of the frames disagree; ways (border shape, 5)."""
    way = float(ways[:, 0].mean())
    apart = np.abs(ways[:, [1, 3]] - ways[:, [2, 4]])
    halves = (apart < agree * np.abs(ways[:, :1])).all()
    return way if halves and abs(ways[0, 0] - ways[1, 0]) < agree * abs(way) else 0.0


def _ways(along: Floats, square: Floats) -> Floats:
    """(5,) place of least cost: of all frames, of even and odd ones, of even and odd quarters; square (frame, place)."""
    frame = np.arange(len(square))
    quarter = frame * 4 // max(len(frame), 1)
    sets = (frame >= 0, frame % 2 == 0, frame % 2 == 1, quarter % 2 == 0, quarter % 2 == 1)
    return np.array([_least(along, square[chosen].sum(axis=0)) for chosen in sets])


def _least(along: Floats, cost: Floats) -> float:
    """Where the parabola through the least of the costs and its neighbours is least; along and cost (place,)."""
    k = int(cost.argmin())
    if k in (0, len(cost) - 1):
        return float(along[k])
    before, least, after = cost[k - 1 : k + 2]
    bend = max(float(before - 2.0 * least + after), np.finfo(float).tiny)
    return float(along[k] + (along[1] - along[0]) * 0.5 * (before - after) / bend)


def _end(V: Floats, tree: FirstTree, joint: int) -> Floats:
    """(xyz,) the vertex of a part that is farthest from its joint."""
    own = V[tree.label == joint]
    return np.asarray(own[np.linalg.norm(own - tree.rest[joint], axis=1).argmax()])


def _limb(
    V: Floats, N: Floats, area: Floats, edge: Ints, tree: FirstTree, joint: int, end: Floats, axis: Floats,
    chosen: HingePlacesSettings,
) -> HingedLimb:  # fmt: skip
    """Points of the two parts at a joint; edge (edge, 2) of the surface."""
    above, radius, centre = int(tree.parents[joint]), float(tree.radius[joint]), tree.rest[joint]
    weight = tree.W[:, above] + tree.W[:, joint]
    own = np.flatnonzero(np.isin(tree.label, (above, joint)) & (weight > chosen.rigid_weight))
    own = own[:: max(len(own) // chosen.points, 1)]
    beyond, away = tree.label[own] == joint, V[own] - centre
    pair = np.sort(tree.label[edge], axis=1) == sorted((above, joint))
    middles = V[edge[pair.all(axis=1)]].mean(axis=1)
    level = away @ axis if not len(middles) else np.where(beyond, 1.0, -1.0) * KDTree(middles).query(V[own])[0]
    places = chosen.places * radius
    near = np.linalg.norm(away, axis=1) < chosen.near * radius
    far = [[np.where(near, height > place, beyond) for place in places] for height in (away @ axis, level)]
    mass = np.maximum(weight[own], 1e-3) ** 2 * area[own] / area.mean()
    return HingedLimb(joint, end, V[own], N[own], mass, centre + places[:, None] * axis, np.array(far))


def _both_sides(far: Flags, least: int) -> Flags:
    """Whether so many points lie on either side of a hinge; far (…, point)."""
    count = far.sum(axis=-1)
    return np.asarray((count >= least) & (far.shape[-1] - count >= least))


def _left(limb: HingedLimb, tree: FirstTree, f: int, target: Target, least: int) -> Floats:
    """(border shape, place) mean squared distance of the parts from a frame's surface, mesh unit²."""
    above = int(tree.parents[limb.joint])
    start = PiecePose(tree.R[f, above], tree.t[f, above], tree.R[f, above].T @ tree.R[f, limb.joint])
    square = np.full(limb.far.shape[:2], (FREE.most_left * target.size) ** 2)
    middle = len(limb.hinge) // 2
    pieces = [
        [Piece(limb.V, limb.N, limb.mass, far, at, at) for far, at in zip(row, limb.hinge, strict=True)] for row in limb.far
    ]
    y, n, _ = placed_piece(pieces[0][middle], start)
    match = target.nearest(y, n)
    for shape, place in np.ndindex(square.shape):
        piece = pieces[shape][place]
        if _both_sides(piece.far, least):
            fit = piece_fit(piece, start, np.zeros(3), target, match, hinged=True, settings=FREE)
            square[shape, place] = fit.cost(limb.mass)
    return square
