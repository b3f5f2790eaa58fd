"""Parts of a body laid by themselves on the frames' own surfaces (ours, see `surface_joints`)."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.hinge_costs import hinge_costs
from kinetree.tasks.numerics.structure.hinge_places import HingeCosts
from kinetree.tasks.numerics.structure.hinged_piece import laid_as_one, sampled_piece
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFitSettings, PiecePose, shift_stiffness

EXACT = 1e-4
"""Least distance of a part from a surface, share of the root of the area: a reference has none from its own."""


class LaidPartsSettings(NamedTuple):
    """Which parts are laid on which frames. Not varied."""

    rigid_weight: float = 0.75
    """Skinning weight from which on a vertex is laid on the surface with its part."""
    least_vertices: int = 12
    """Such vertices of a part, at least."""
    least_frames: int = 8
    """Frames, at least."""
    most_frames: int = 40
    """Frames that are looked at, evenly spread; for time."""


class LaidParts(NamedTuple):
    """Parts on the surfaces of some frames.

    frame                 : (laid,) place among the frames, ascending
    joint                 : (part,) about which each part turns, in the tree's order, ascending
    rotation, translation : (laid, part, 3, 3) · (laid, part, xyz) from the reference, mesh unit
    stiffness             : (laid, part, 6, 6) of the fit about the part's joint, see `shift_stiffness`
    square                : (laid, part) mean squared distance from the surface, mesh unit²
    hinges                : what parts leave of these surfaces in pairs, with a hinge at several places
    """

    frame: Ints
    joint: Ints
    rotation: Floats
    translation: Floats
    stiffness: Floats
    square: Floats
    hinges: HingeCosts


def laid_frames(count: int, settings: LaidPartsSettings | None = None) -> Ints:
    """Frames on which parts are laid, of so many, ascending; none where there are few."""
    chosen = settings or LaidPartsSettings()
    frames = np.unique(np.linspace(0, count - 1, min(count, chosen.most_frames)).round().astype(np.int64))
    return frames if len(frames) >= chosen.least_frames else frames[:0]


def laid_parts(
    V: Floats, F: Ints, area: Floats, tree: FirstTree, surfaces: Mapping[int, Target], settings: LaidPartsSettings | None = None
) -> LaidParts:
    """All parts with enough vertices, each by itself from where it is aligned; and pairs of them with a hinge.

    V, F, area : (vertex, xyz) reference, mesh unit · (face, corner) · (vertex,) mesh unit²
    surfaces   : by place among the frames, prepared surfaces
    """
    pieces, rows = _pieces(V, F, area, tree, settings or LaidPartsSettings()), []
    for f, target in surfaces.items():
        starts = {p: PiecePose(tree.R[f, p], tree.t[f, p], np.eye(3)) for p in pieces}
        rows.append([_on_surface(piece, starts[p], target) for p, piece in pieces.items()])
    shapes = (3, 3), (3,), (6, 6), ()
    R, t, stiffness, square = (
        np.array([[fit[k] for fit in row] for row in rows]).reshape(len(rows), len(pieces), *n) for k, n in enumerate(shapes)
    )
    hinges = hinge_costs(V, F, area, tree, surfaces)
    return LaidParts(np.array(list(surfaces), np.int64), np.array(list(pieces), np.int64), R, t, stiffness, square, hinges)


def _pieces(V: Floats, F: Ints, area: Floats, tree: FirstTree, chosen: LaidPartsSettings) -> dict[int, Piece]:
    """Points of the parts that have enough vertices; each turns about its own middle, since fits damp turns by their lever."""
    pieces, N = {}, smoothed_normals(V, F)
    for part in range(len(tree.parents)):
        own = np.flatnonzero((tree.label == part) & (tree.W[:, part] > chosen.rigid_weight))
        if len(own) >= chosen.least_vertices:
            mass = tree.W[own, part] * np.sqrt(area[own] / area.sum())
            middle = np.average(V[own], axis=0, weights=mass**2)
            pieces[part] = sampled_piece(V[own], N[own], mass, np.zeros(len(own), np.bool_), middle, tree.rest[part])
    return pieces


def _on_surface(piece: Piece, start: PiecePose, target: Target) -> tuple[Floats, Floats, Floats, float]:
    """One part in one frame: rotation, shift, stiffness and squared distance."""
    fit = laid_as_one(piece, start, np.zeros(3), target, PieceFitSettings(anchor=0.0))
    H = shift_stiffness(piece, fit, target)
    return fit.pose.R, fit.pose.t, H, max(fit.cost(piece.mass), (EXACT * target.size) ** 2)
