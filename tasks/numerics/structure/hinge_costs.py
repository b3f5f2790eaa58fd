"""Pairs of parts laid on the frames' surfaces as one piece with a hinge, at several places of their limb (ours)."""

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.hinge_places import HingeCosts, HingePlacesSettings, limb_axis
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFitSettings, PiecePose, piece_fit, placed_piece

FREE = PieceFitSettings(anchor=0.0)
"""The two parts lie on the surface by themselves; the rest of the body does not hold them."""


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


def hinged_limbs(
    V: Floats, F: Ints, area: Floats, tree: FirstTree, settings: HingePlacesSettings | None = None,
    joints: Collection[int] | None = None,
) -> list[HingedLimb]:  # fmt: skip
    """The joints whose bones are nearly long and straight enough, with the points of their parts.

    V, F, area : (vertex, xyz) reference, mesh unit · (face, corner) · (vertex,) mesh unit²
    joints     : which are asked; None asks all
    """
    chosen, N, limbs = settings or HingePlacesSettings(), smoothed_normals(V, F), []
    edge = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    nearly = [of._replace(length=of.margin * of.length, straight=of.margin * of.straight) for of in (chosen, chosen.of_short)]
    asked = {*tree.label.tolist()} - {0}
    for joint in sorted(asked if joints is None else asked & {*joints}):
        end = _end(V, tree, joint)
        axis = next((axis for of in nearly if (axis := limb_axis(tree, tree.rest, joint, end, of)) is not None), None)
        if axis is not None:
            limb = _limb(V, N, area, edge, tree, joint, end, axis, chosen)
            if _both_sides(limb.far[:, len(limb.hinge) // 2], chosen.least_points).all():
                limbs.append(limb)
    return limbs


def hinge_costs(
    V: Floats, F: Ints, area: Floats, tree: FirstTree, surfaces: Mapping[int, Target],
    settings: HingePlacesSettings | None = None, joints: Collection[int] | None = None,
) -> HingeCosts:  # fmt: skip
    """Lays the parts at every joint of `hinged_limbs` on surfaces, with a hinge at each place.

    surfaces : by place among the frames, prepared surfaces
    """
    chosen, limbs = settings or HingePlacesSettings(), hinged_limbs(V, F, area, tree, settings, joints)
    shape = (len(surfaces), len(limbs), 2, len(chosen.places))
    square = [[_left(limb, tree, f, target, chosen.least_points) for limb in limbs] for f, target in surfaces.items()]
    return HingeCosts(
        np.array([limb.joint for limb in limbs], np.int64),
        np.array([limb.end for limb in limbs]).reshape(-1, 3),
        np.array(square, np.float64).reshape(shape),
    )


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
