"""Joints within limbs, moved to where the frames' own surfaces have them (ours).

An alignment carries the surface near a border along with one of the two parts, in all frames alike, so that every cut puts the
joint at the same wrong place. The two parts are therefore laid on the surfaces by themselves. A tube may slide along its axis
and says nothing there: each part counts in a direction as firmly as its fit holds the joint,

    c = argmin Σ_f w_f e_fᵀ (S_f / n)⁻¹ e_f + |c − c₀|² / (ρ r)²,   e_f = (I − R_aᵀ R_b) c − R_aᵀ (t_b − t_a)

with c₀ the joint as it is, r the radius of its border, and S_f = Σ over both parts of σ² K⁻¹, K the stiffness of the part's fit
against a shift of the joint, its rotation free. A joint is moved only where halves of the frames move it alike.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.hinged_piece import SAMPLE, laid_as_one, sampled_piece
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFitSettings, PiecePose, shift_stiffness
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints

SINGULAR = 1e-9
"""Added to a stiffness against a shift, which is 1 where all points of a part hold it, and to one against a turn, share of its
trace: keeps them invertible where no match holds a part."""

EXACT = 1e-4
"""Least distance of a part from a surface, share of the root of the area: a reference has none from its own."""


class SurfaceJointsSettings(NamedTuple):
    """How far joints go, and which.

    The first three were chosen on wave, dance, ballet, wolf, generated bodies of seeds 0 to 6 and people 0 to 6 in takes.
    """

    spread: float = 0.35
    """ρ: standard deviation of a joint about its place, in radii of its border. 0.15 to 0.4 win alike on those."""
    points: float = 3.0
    """n: as how many points without a common error a part's surface counts. With ten times as many joints get worse."""
    agree: float = 0.5
    """Distance between the places that two halves of the frames give, share of the way that all go, at most. At 0.7 more joints
    move, of which more get worse."""
    rigid_weight: float = 0.75
    """Skinning weight from which on a vertex is laid on the surface with its part. Not varied."""
    least_vertices: int = 12
    """Such vertices of a part, at least. Not varied."""
    outlier: float = 3.0
    """Distance in medians over the frames at which a frame counts a half. Not varied."""
    rounds: int = 3
    """Rounds of weighting frames anew. Not varied."""
    least_frames: int = 8
    """Frames that show both parts, at least. Not varied."""
    most_frames: int = 40
    """Frames that are looked at, evenly spread; for time. Not varied."""


class _Laid(NamedTuple):
    """A part in the frames: R (frame, 3, 3), t (frame, xyz), stiffness (frame, 6, 6) about the origin, square (frame,)."""

    R: Floats
    t: Floats
    H: Floats
    square: Floats


class _Pull(NamedTuple):
    """What frames say of one joint: M c = d, weighted by Q (frame, 3, 3), seen (frame,)."""

    M: Floats
    d: Floats
    Q: Floats
    seen: Floats


def surface_joints(
    body: MovingSurface,
    found: TreeJoints,
    rest: Floats,
    confidence: Floats,
    surface: Callable[[int], tuple[Floats, Ints]],
    settings: SurfaceJointsSettings | None = None,
) -> Floats:
    """(part, xyz) the joints in the reference, those within limbs moved where the frames agree on it, mesh unit.

    rest       : (part, xyz) the joints in the reference, mesh unit
    confidence : (frame, vertex) 0 to 1
    surface    : gives a frame's mesh, V (source, xyz) mesh unit and F (face, corner), by its place among the frames
    """
    chosen, parents = settings or SurfaceJointsSettings(), found.left.part_tree.tree.parents
    joints, moved = np.flatnonzero(within_limbs(parents)), rest.copy()
    frames = _even(len(body.x), chosen.most_frames)
    parts = np.union1d(joints, parents[joints])
    laid = _laid(body, found, parts, frames, surface, chosen) if len(frames) >= chosen.least_frames else {}
    share = confident_share(found.label, body.area, confidence, len(body.x), len(parents))[frames]
    border = found.left.part_tree.tree.border
    for joint in joints.tolist():
        above = int(parents[joint])
        if joint in laid and above in laid:
            pull = _pull(laid[above], laid[joint], rest[joint], np.minimum(share[:, above], share[:, joint]), chosen)
            radius = float(found.left.part_tree.borders.radius[border[joint]])
            moved[joint] = _agreed(pull, rest[joint], chosen.spread * radius, chosen)
    return moved


def within_limbs(parents: Ints) -> Flags:
    """(part,) whether a part hangs on one that is not the root and has no other part below it.

    Flesh around hips, shoulders and necks bends on its own: there rigid pieces lead away from the joint.
    """
    below = np.bincount(parents[1:], minlength=len(parents))
    above = np.maximum(parents, 0)
    return np.asarray((parents > 0) & (below[above] == 1))


def _even(count: int, most: int) -> Ints:
    """Frames that are looked at, ascending."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def _laid(
    body: MovingSurface, found: TreeJoints, parts: Ints, frames: Ints, surface: Callable[[int], tuple[Floats, Ints]],
    chosen: SurfaceJointsSettings,
) -> dict[int, _Laid]:  # fmt: skip
    """Parts by themselves on the frames' surfaces, from where they are aligned; those with enough vertices."""
    pieces, N = {}, smoothed_normals(body.V, body.F)
    for part in parts.tolist():
        own = np.flatnonzero((found.label == part) & (found.W[:, part] > chosen.rigid_weight))
        if len(own) >= chosen.least_vertices:
            mass = found.W[own, part] * np.sqrt(body.area[own] / body.area.sum())
            pieces[part] = sampled_piece(body.V[own], N[own], mass, np.zeros(len(own), np.bool_), np.zeros(3), np.zeros(3))
    rows: dict[int, list[_Laid]] = {part: [] for part in pieces}
    for f in frames.tolist() if pieces else ():
        target = Target.of(*surface(f), body.size, SAMPLE)
        for part, piece in pieces.items():
            rows[part].append(_on_surface(piece, PiecePose(found.R[f, part], found.t[f, part], np.eye(3)), target))
    return {part: _Laid(*(np.stack(of) for of in zip(*row, strict=True))) for part, row in rows.items()}


def _on_surface(piece: Piece, start: PiecePose, target: Target) -> _Laid:
    """One part in one frame."""
    fit = laid_as_one(piece, start, np.zeros(3), target, PieceFitSettings(anchor=0.0))
    H = shift_stiffness(piece, fit, target)
    return _Laid(fit.pose.R, fit.pose.t, H, np.asarray(max(fit.cost(piece.mass), (EXACT * target.size) ** 2)))


def _pull(above: _Laid, own: _Laid, c: Floats, seen: Floats, chosen: SurfaceJointsSettings) -> _Pull:
    """The equations of a joint at c in all frames, in the axes of the part above."""
    back = above.R.transpose(0, 2, 1)
    loose = np.zeros_like(back)
    for laid in (above, own):
        loose += laid.square[:, None, None] * np.linalg.inv(_joint_stiffness(laid, c))
    M = np.eye(3) - back @ own.R
    d = np.einsum("fxy,fy->fx", back, own.t - above.t)
    Q = chosen.points * np.linalg.inv(back @ loose @ above.R)
    return _Pull(M, d, np.asarray(Q, np.float64), seen)


def _joint_stiffness(laid: _Laid, c: Floats) -> Floats:
    """(frame, 3, 3) how firmly the fits hold a part's point c, its rotation free."""
    y = np.einsum("fxy,y->fx", laid.R, c) + laid.t
    about = np.tile(np.eye(6), (len(y), 1, 1))
    for x in range(3):
        a, b = (x + 1) % 3, (x + 2) % 3
        about[:, 3 + a, b], about[:, 3 + b, a] = -y[:, x], y[:, x]
    H = about.transpose(0, 2, 1) @ laid.H @ about
    turn, both, shift = H[:, :3, :3], H[:, :3, 3:], H[:, 3:, 3:]
    trace = np.maximum(np.trace(turn, axis1=1, axis2=2), 1e-100)
    free = np.linalg.solve(turn + SINGULAR * trace[:, None, None] * np.eye(3), both)
    return np.asarray(shift - both.transpose(0, 2, 1) @ free + SINGULAR * np.eye(3))


def _agreed(pull: _Pull, c: Floats, sigma: float, chosen: SurfaceJointsSettings) -> Floats:
    """(xyz,) the joint moved, or as it is where halves of the frames disagree: each second frame, each second quarter."""
    count = len(pull.seen)
    way = _centre(pull, c, sigma, chosen) - c
    far = chosen.agree * float(np.linalg.norm(way))
    for half in (np.arange(count) % 2, np.arange(count) * 4 // count % 2):
        one, other = (_centre(_Pull(*(a[half == k] for a in pull)), c, sigma, chosen) for k in (0, 1))
        if not np.linalg.norm(one - other) < far:
            return c
    return np.asarray(c + way)


def _centre(pull: _Pull, c: Floats, sigma: float, chosen: SurfaceJointsSettings) -> Floats:
    """(xyz,) the rotation centre of some frames, drawn to c; frames that stay off count less."""
    w, at, hold = pull.seen + 1e-3, c, np.eye(3) / sigma**2
    for _ in range(chosen.rounds):
        A = np.einsum("f,fyx,fyz,fzw->xw", w, pull.M, pull.Q, pull.M)
        g = np.einsum("f,fyx,fyz,fz->x", w, pull.M, pull.Q, pull.d)
        at = np.linalg.solve(A + hold, g + hold @ c)
        e = pull.M @ at - pull.d
        off = np.sqrt(np.einsum("fx,fxy,fy->f", e, pull.Q, e))
        w = (pull.seen + 1e-3) / (1.0 + (off / max(chosen.outlier * float(np.median(off)), 1e-300)) ** 2)
    return np.asarray(at)
