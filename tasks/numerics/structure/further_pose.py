"""The finished body posed in one frame by itself, held as in a known frame where little is seen (2014, Sec. 7.3; ours)."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_fit import Motion
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, SkinnedBody, relative_rotations
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings, confident_share, frame_poses
from kinetree.tasks.numerics.structure.hinged_piece import laid_as_one, laid_hinged, motions, on_pieces, sampled_piece
from kinetree.tasks.numerics.structure.piece_fit import PiecePose
from kinetree.tasks.numerics.structure.pose_refinement import KnownPoses


class FurtherPose(NamedTuple):
    """A frame's pose.

    pose       : rotations of all parts and the root's joint
    confidence : (part,) 0 to 1, as in `frame_poses`
    seen       : (part,) whether most of it and of its parent was certain
    """

    pose: FramePose
    confidence: Floats
    seen: Flags


def further_pose(
    body: SkinnedBody, x: Floats, confidence: Floats | None, known: KnownPoses, distance: Ints, ends: Sequence[int] = (),
    surface: Callable[[], Target] | None = None,
) -> FurtherPose:  # fmt: skip
    """The pose that the aligned vertices show, and beyond end joints the surface.

    body       : as it was learned
    x          : (vertex, xyz) where each vertex is aligned to, mesh unit
    confidence : (vertex,) 0 to 1; None where every vertex was followed
    known      : poses of the frames that the body was learned from
    distance   : (frame,) how far each of these is in time; a part that is not seen is held as in the nearest that saw it
    ends       : parts beyond end joints, whose turn aligned vertices smear
    surface    : gives the frame's surface, which is asked for where there are such parts; None leaves them as aligned
    """
    parts = len(body.parents)
    area = surface_areas(body.V, body.F)
    W = np.zeros((len(body.V), parts))
    np.add.at(W, (np.arange(len(W))[:, None], body.bound), body.weight)
    weight = np.ones(len(x)) if confidence is None else np.maximum(confidence, 1e-6)
    above = np.maximum(body.parents, 0)
    expected = _nearest_turns(known, body.parents, distance)
    rows = None if confidence is None else confidence[None]
    share = confident_share(body.label, area, rows, 1, parts)[0]
    seen = np.minimum(share, share[above]) >= FramePosesSettings().seen
    if surface is not None and seen[list(ends)].any():
        x = _on_surface(body, W, x, area * weight, [p for p in ends if seen[p]], expected[0], surface())
    start = _rigid_parts(body, x, area * weight)
    found = frame_poses(body.V, x[None], area, body.label, W, start, body.parents, rows, expected=expected)
    root = found.motion.x[0] + found.motion.R[0, 0] @ body.rest[0]
    return FurtherPose(FramePose(found.motion.R[0], root), found.confidence[0], seen)


def _on_surface(
    body: SkinnedBody, W: Floats, x: Floats, mass: Floats, ends: Sequence[int], turn: Floats, target: Target
) -> Floats:
    """(vertex, xyz) where the two pieces of every limb with an end joint lie on the surface; elsewhere as aligned.

    W    : (vertex, part) · mass : (vertex,)
    turn : (part, 3, 3) rotation of each part against its parent in another frame
    """
    x = x.copy()
    for far in ends:
        near = int(body.parents[far])
        above, own = _part_above(body, near), np.flatnonzero(np.isin(body.label, [near, far]))
        weight = W[own, near] + W[own, far]
        hinge, joint = body.rest[far], body.rest[near]
        if near == 0 and (
            beside := [k for k in np.flatnonzero(body.parents == 0).tolist() if k != far and (body.label == k).any()]
        ):
            above = max(beside, key=lambda k: int((body.label == k).sum()))
            joint = body.rest[above]
        piece = sampled_piece(body.V[own], body.N[own], weight, body.label[own] == far, hinge, joint)
        (R, t), (Q, u) = (_rigid_part(body, x, mass, parts) for parts in ([near, far], [above]))
        goal = Q @ joint + u
        one = laid_as_one(piece, PiecePose(R, t, np.eye(3)), goal, target)
        moved = motions(laid_hinged(piece, one, goal, target, turn[far]).pose, hinge)
        x[own] = on_pieces(body.V[own], x[own], weight, W[own, far] / np.maximum(weight, 1e-12), *moved)
    return x


def _part_above(body: SkinnedBody, part: int) -> int:
    """The nearest part above that has vertices, which a bone under the skin has not; the part itself where there is none."""
    above = int(body.parents[part])
    while above >= 0 and not (body.label == above).any():
        above = int(body.parents[above])
    return above if above >= 0 else part


def _rigid_parts(body: SkinnedBody, x: Floats, mass: Floats) -> Motion:
    """Every part where its own vertices are: where a fit starts."""
    R = np.empty((1, len(body.parents), 3, 3))
    shift = np.zeros(3)
    for p in range(len(body.parents)):
        R[0, p], t = _rigid_part(body, x, mass, [p]) if (body.label == p).any() else (R[0, body.parents[p]], shift)
        shift = t if p == 0 else shift
    return Motion(body.rest, R, shift[None])


def _rigid_part(body: SkinnedBody, x: Floats, mass: Floats, parts: Sequence[int]) -> tuple[Floats, Floats]:
    """(3, 3) · (xyz,) the motion of the vertices of some parts."""
    mine = np.isin(body.label, parts)
    return rigid_motion(body.V[mine], x[mine], mass[mine])


def _nearest_turns(known: KnownPoses, parents: Ints, distance: Ints) -> Floats:
    """(1, part, 3, 3) rotation of each part against its parent in the nearest frame that saw both; the nearest if none did."""
    turn = relative_rotations(known.R, parents)
    sure = np.minimum(known.confidence, known.confidence[:, np.maximum(parents, 0)])
    far = np.where(sure >= FramePosesSettings().seen, 0, distance.max() + 1) + distance[:, None]
    return turn[far.argmin(axis=0), np.arange(len(parents))][None]
