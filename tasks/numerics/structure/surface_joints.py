"""Joints moved to where the frames' own surfaces have them (ours).

An alignment carries the surface near a border along with one of the two parts, in all frames alike, so that every cut puts the
joint at the same wrong place. The two parts are therefore laid on the surfaces by themselves. A tube may slide along its axis
and says nothing there: each part counts in a direction as firmly as its fit holds the joint,

    c = argmin Σ_f w_f e_fᵀ Q_f e_f + |c − c₀|² / (ρ r)²,   e_f = M_f c − R_aᵀ (t_b − t_a),   M_f = I − R_aᵀ R_b

with c₀ the joint as it is, r the radius of its border, and Q_f = n S_f⁻¹, S_f = Σ over both parts of σ² K⁻¹, K the stiffness
of the part's fit against a shift of the joint, its rotation free; across the centre line of a long part ρ is smaller. A joint
within a limb is moved there only where halves of the frames move it alike; any other, and one that stays, goes along its limb
to where the surfaces bend, see `hinge_places`. A joint that neither of these moves goes a part of the way, s |s|² / (|s|² + δ
v) with

    s = (A + λ C)⁻¹ Σ_f w_f M_fᵀ Q_f d_f,   A = Σ_f w_f M_fᵀ Q_f M_f,   d_f = −e_f at c₀

λ the largest eigenvalue of A, C = κ I where no line is, larger across the centre line of a long part and smaller along it
(`hold_across`, `hold_along`), v the mean, over two ways of halving the frames, of the square of half the distance between what
halves give. So it goes where the frames hold it firmly, without a line 1 / (1 + κ) of the way at most, and less far where
halves disagree. With a wide ρ the surfaces place c almost alone; how far halves of the frames then put it from the joint says
how well that one is placed.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.centre_lines import about_lines
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings
from kinetree.tasks.numerics.structure.hinge_places import hinge_offsets, hinge_shifts
from kinetree.tasks.numerics.structure.laid_parts import LaidParts, LaidPartsSettings
from kinetree.tasks.numerics.structure.score_spans import score_spans

SINGULAR = 1e-9
"""Added to a stiffness against a shift, which is 1 where all points of a part hold it, and to one against a turn, share of its
trace: keeps them invertible where no match holds a part."""
NO_STIFFNESS: Floats = np.zeros((3, 3))
"""A joint that is not drawn to where it is."""


class SurfaceJointsSettings(NamedTuple):
    """How far joints go.

    The first three were chosen on wave, dance, ballet, wolf, generated bodies of seeds 0 to 6 and people 0 to 6 in takes.
    """

    spread: float = 0.35
    """ρ: standard deviation of a joint about its place, in radii of its border. 0.15 to 0.4 win alike on those."""
    free_spread: float = 6.0
    """The same where the surfaces alone place joints. Chosen on generated bodies of even seeds: 3 to 10 tell badly placed
    joints alike, 0.35 tells them no better than without."""
    points: float = 3.0
    """n: as how many points without a common error a part's surface counts. With ten times as many joints get worse."""
    across: float = 0.25
    """The same across the centre line on which a joint lies. Chosen with `hold_across` on the bodies named there; at 0.15 they
    win alike but for ballet, which loses."""
    agree: float = 0.5
    """Distance between the places that two halves of the frames give, share of the way that all go, at most. At 1 joints of
    generated bodies lie nearer by 1 to 3 %, those of recorded ones by nothing, and a wolf's farther."""
    hold: float = 0.3
    """κ: stiffness that draws a joint to where it is, share of the frames' stiffness in their firmest direction. Chosen on
    people 0 to 14, humans, quadrupeds and random trees of seeds 0 to 9, wave, dance, ballet and wolf. From 0.3 to 0.5 they
    win alike; at 0.1 people win more, and quadrupeds lose."""
    hold_across: float = 2.0
    """The same across the centre line of a long part. Chosen with `hold_along` on people 0 to 14, 100 to 114 and, at 6
    frames a second, 55 to 69, humans, quadrupeds and random trees 0 to 4, humans 20 to 29, wave, dance, ballet, wolf and the
    recorded rig in eight motions, all of which it brings nearer. From 1 to 4 they win alike."""
    hold_along: float = 0.1
    """The same along it. From 0.02 to 0.1 those win alike, recorded ones the more the larger; at 0.3 they win half of that."""
    doubt: float = 6.0
    """δ: weight of the disagreement of halves against the way. Of the bodies that `hold_across` names people win 1 % at 6
    against 12 and recorded ones half of that, quadrupeds and random trees lose less than 1 %; at 3 all of this is more."""
    farthest: float = 0.5
    """Length of such a way at most, in radii of the border. The longest of 616 on such bodies has 0.42."""
    outlier: float = 3.0
    """Distance in medians over the frames at which a frame counts a half. Not varied."""
    rounds: int = 3
    """Rounds of weighting frames anew. Not varied."""


class SurfaceJoints(NamedTuple):
    """Joints as the frames' surfaces have them.

    rest   : (part, xyz) in the reference, moved where the frames agree on it, mesh unit
    offset : (part,) root mean square distance of each joint from where halves of the surfaces alone have it, mesh unit; NaN
             where too few frames show both parts
    hinge  : (part,) the same along the limb, from where halves of the surfaces bend it, see `hinge_offsets`
    """

    rest: Floats
    offset: Floats
    hinge: Floats


class _PartFits(NamedTuple):
    """A part in the frames: R (frame, 3, 3), t (frame, xyz), stiffness (frame, 6, 6) about its joint, square (frame,), and
    that joint in the reference (xyz,).
    """

    R: Floats
    t: Floats
    H: Floats
    square: Floats
    joint: Floats


class _Pull(NamedTuple):
    """What frames say of the shift s of one joint: M s = d, weighted by Q (frame, 3, 3), seen (frame,).

    The shift and not the place: of a body far from the origin a place has no digits left for it.
    """

    M: Floats
    d: Floats
    Q: Floats
    seen: Floats


def surface_joints(
    tree: FirstTree, laid: LaidParts, rest: Floats, seen: Floats, settings: SurfaceJointsSettings | None = None,
    held: Flags | None = None, takes: Sequence[slice] | None = None, lines: Floats | None = None,
) -> SurfaceJoints:  # fmt: skip
    """Joints where the frames agree on them, and how far all are from where the surfaces have them.

    rest  : (part, xyz) the joints in the reference, mesh unit
    seen  : (frame, part) share of its surface that is certain, 0 to 1
    held  : (part,) joints that stay where they are, see `shared_joints`; None holds none
    takes : positions of the frames of each take, in order; None takes all as one
    lines : (part, 3, 3) Σ w a aᵀ over the centre lines a near each joint, see `ExpectedJoints`; None where there are none
    """
    chosen, stays = settings or SurfaceJointsSettings(), np.zeros(len(rest), np.bool_) if held is None else held
    on_lines = np.zeros((len(rest), 3, 3)) if lines is None else lines
    firm = about_lines(on_lines, chosen.spread**-2, chosen.across**-2, chosen.spread**-2)
    hold = about_lines(on_lines, chosen.hold, chosen.hold_across, chosen.hold_along)
    may_move = within_limbs(tree.parents) & ~stays & ~tree.in_divided_trunk
    share, moved, offset = seen[laid.frame], rest.copy(), np.full(len(rest), np.nan)
    spans = [(laid.frame >= first) & (laid.frame < behind) for first, behind in score_spans(len(seen), takes)]
    shifts = hinge_shifts(tree, laid.hinges, rest, share, spans)
    parts = {
        part: _PartFits(laid.rotation[:, k], laid.translation[:, k], laid.stiffness[:, k], laid.square[:, k], tree.rest[part])
        for k, part in enumerate(laid.joint.tolist())
    }
    for joint, above in enumerate(tree.parents.tolist()):
        if joint in parts and above in parts:
            pull = _pull(parts[above], parts[joint], rest[joint], np.minimum(share[:, above], share[:, joint]), chosen)
            radius = float(tree.radius[joint])
            if may_move[joint]:
                moved[joint] += _agreed_shift(pull, firm[joint] / radius**2, chosen)
            if _often_shown(pull):
                if not stays[joint] and (moved[joint] == rest[joint]).all():
                    bends = shifts[joint].any()
                    moved[joint] += shifts[joint] if bends else _shortened_shift(pull, hold[joint], radius, chosen)
                free = _of_halves(pull, np.eye(3) / (chosen.free_spread * radius) ** 2, NO_STIFFNESS, chosen)
                left = free - (moved[joint] - rest[joint])
                offset[joint] = np.sqrt(np.square(left).sum(axis=2).mean())
    return SurfaceJoints(moved, offset, hinge_offsets(tree, laid.hinges, moved, share))


def within_limbs(parents: Ints) -> Flags:
    """(part,) whether a part hangs on one that is not the root and has no other part below it.

    Flesh around hips, shoulders and necks bends on its own: there rigid pieces lead away from the joint.
    """
    below = np.bincount(parents[1:], minlength=len(parents))
    above = np.maximum(parents, 0)
    return np.asarray((parents > 0) & (below[above] == 1))


def _often_shown(pull: _Pull) -> bool:
    """Whether enough frames show both parts; without them centres stay where the joint is, as if the surfaces had it there."""
    return int((pull.seen >= FramePosesSettings().seen).sum()) >= LaidPartsSettings().least_frames


def _pull(above: _PartFits, own: _PartFits, c: Floats, seen: Floats, chosen: SurfaceJointsSettings) -> _Pull:
    """The equations of a joint at c in all frames, in the axes of the part above."""
    back = above.R.transpose(0, 2, 1)
    loose = np.zeros_like(back)
    for laid in (above, own):
        loose += laid.square[:, None, None] * np.linalg.inv(_joint_stiffness(laid, c))
    M = np.eye(3) - back @ own.R
    d = np.einsum("fxy,fy->fx", back, (own.R @ c + own.t) - (above.R @ c + above.t))
    Q = chosen.points * np.linalg.inv(back @ loose @ above.R)
    return _Pull(M, d, np.asarray(Q, np.float64), seen)


def _joint_stiffness(laid: _PartFits, c: Floats) -> Floats:
    """(frame, 3, 3) how firmly the fits hold a part's point c, its rotation free."""
    y = laid.R @ (c - laid.joint)
    about = np.tile(np.eye(6), (len(y), 1, 1))
    for x in range(3):
        a, b = (x + 1) % 3, (x + 2) % 3
        about[:, 3 + a, b], about[:, 3 + b, a] = -y[:, x], y[:, x]
    H = about.transpose(0, 2, 1) @ laid.H @ about
    turn, both, shift = H[:, :3, :3], H[:, :3, 3:], H[:, 3:, 3:]
    trace = np.maximum(np.trace(turn, axis1=1, axis2=2), 1e-100)
    free = np.linalg.solve(turn + SINGULAR * trace[:, None, None] * np.eye(3), both)
    return np.asarray(shift - both.transpose(0, 2, 1) @ free + SINGULAR * np.eye(3))


def _agreed_shift(pull: _Pull, firm: Floats, chosen: SurfaceJointsSettings) -> Floats:
    """(xyz,) where the joint goes from where it is, mesh unit; nowhere where halves of the frames disagree."""
    way = _shift(pull, firm, NO_STIFFNESS, chosen)
    one, other = _of_halves(pull, firm, NO_STIFFNESS, chosen)
    agree = np.linalg.norm(one - other, axis=1) < chosen.agree * np.linalg.norm(way)
    return way if agree.all() else np.zeros(3)


def _shortened_shift(pull: _Pull, hold: Floats, radius: float, chosen: SurfaceJointsSettings) -> Floats:
    """(xyz,) a part of the way to the rotation centre, the less the more halves disagree; radius of the border, mesh unit."""
    way = _shift(pull, NO_STIFFNESS, hold, chosen)
    one, other = _of_halves(pull, NO_STIFFNESS, hold, chosen)
    square, disagreement = float(way @ way), float(np.square((one - other) / 2.0).sum(axis=1).mean())
    way = way * square / max(square + chosen.doubt * disagreement, 1e-300)
    return np.asarray(way * min(1.0, chosen.farthest * radius / max(float(np.linalg.norm(way)), 1e-300)))


def _of_halves(pull: _Pull, firm: Floats, hold: Floats, chosen: SurfaceJointsSettings) -> Floats:
    """(half, way to halve, xyz) the shifts by each second frame and by the others, and by each second quarter."""
    frame = np.arange(len(pull.seen))
    halves = (frame % 2, frame * 4 // len(frame) % 2)
    return np.array([[_shift(_Pull(*(a[half == k] for a in pull)), firm, hold, chosen) for half in halves] for k in (0, 1)])


def _shift(pull: _Pull, firm: Floats, hold: Floats, chosen: SurfaceJointsSettings) -> Floats:
    """(xyz,) from the joint to the rotation centre of some frames, drawn to the joint; frames that stay off count less.

    firm : (3, 3) stiffness that draws it there, 1 / mesh unit²
    hold : (3, 3) the same, share of the frames' stiffness in their firmest direction
    """
    w, way = pull.seen + 1e-3, np.zeros(3)
    for _ in range(chosen.rounds):
        A = np.einsum("f,fyx,fyz,fzw->xw", w, pull.M, pull.Q, pull.M)
        g = np.einsum("f,fyx,fyz,fz->x", w, pull.M, pull.Q, pull.d)
        drawn = firm + float(np.linalg.eigvalsh(A)[-1]) * hold + 1e-300 * np.eye(3)
        way = np.asarray(np.linalg.solve(A + drawn, g))
        e = pull.M @ way - pull.d
        off = np.sqrt(np.einsum("fx,fxy,fy->f", e, pull.Q, e))
        w = (pull.seen + 1e-3) / (1.0 + (off / max(chosen.outlier * float(np.median(off)), 1e-300)) ** 2)
    return way
