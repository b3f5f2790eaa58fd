"""Bones under skin that is nowhere rigid: proposed between two parts that one joint does not join well (ours).

A short neck or a collar moves no vertex by itself: every vertex near it blends it with the parts on both sides, so no cut into
rigid parts can find it. Between two parts of the tree a bone is fitted whose motion is nowhere seen alone (`blended_bone`). It
is one where one joint left the two parts drifting, and where it turns about two points, one on either side, that lie apart.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.blended_bone import MovingSkin, blended_bone, refitted
from kinetree.tasks.numerics.structure.joint_rotations import widest_turning_range
from kinetree.tasks.numerics.structure.rotation_centres import (
    Joints,
    RotationCentresSettings,
    rotation_centres,
    widest_drift,
)
from kinetree.tasks.numerics.structure.score_spans import score_spans


class HiddenBonesSettings(NamedTuple):
    """What makes a bone; lengths are shares of the root of the area where nothing else is said, areas shares of it.

    Chosen on generated people, quadrupeds and random trees of seeds 0 to 9 and on recorded bodies, a dance among them; judged
    on seeds 10 to 19.
    """

    drift: float = 0.0015
    """Drift of the one joint from which on two are tried."""
    less_drift: float = 0.5
    """Drift of both new joints, share of that of the one, at which a smaller one, down to half of `drift`, does too."""
    more_drift: float = 2.5
    """Drift of either new joint in drifts of the one, at most, where the one drifts clearly; else they may drift no more than
    the one does."""
    clear_drift: float = 0.04
    """Drift of the one joint from which on it drifts clearly, in radii of its border: a wide one drifts by as much as a neck's
    where flesh bends. Chosen on a dance and people of even seeds: true bones that need it lie at 0.054 and above, the false one
    at 0.033."""
    steady: float = 0.006
    """Drift of either new joint over all frames, at most: within the take in which it drifts most instead, two of three people
    in several takes lose their necks."""
    apart: float = 0.9
    """Distance between the new joints in radii of the border, at least: a ring of flesh turns about one point."""
    area: float = 0.0058
    """Skin that follows the bone, its weights summed, at least. A true one has 0.00596, a false one 0.00562."""
    degrees: float = 12.0
    """Range by which the bone turns against each side, at least."""
    ratio: float = 2.0
    """Displacement of one new joint that turning about the other gives, in drifts of the latter, at least."""
    reach: float = 2.0
    """Distance from the joint, in radii of its border, within which skin is looked at."""
    narrow: float = 0.04
    """Radius of a border below which skin is looked at as about one of this radius."""
    skin: float = 0.5
    """Weight that the two parts have together at skin that is looked at, at least."""
    least_vertices: int = 20
    """Vertices of that skin, at least."""
    most_vertices: int = 300
    """Vertices that the bone is fitted to, at most; for time."""
    most_frames: int = 36
    """Frames that it is fitted in, about; for time."""
    others: int = 2
    """Further parts that the skin may follow, at most."""
    follower: float = 0.8
    """Share of the largest weight of the bone from which on a vertex counts as its own, if not already as most its own."""
    rounds: int = 25
    """Rounds of weights and motion."""
    generations: int = 2
    """How many times bones are looked for: at all joints, then at those of the bones that were found before. Chosen on a dance
    and people of even seeds; with 3 all results are the same."""
    noise: float = 1e-4
    """Error of a vertex below which its motion says nothing of its weights."""
    prior: RotationCentresSettings = RotationCentresSettings(spread=1.0, frames_alike=3.0, far=2.0)
    """How firmly the new joints are held amid the skin that blends: a collar turns about a point far inside the body."""


class Border(NamedTuple):
    """The joint between two parts, and where their skin meets.

    part, above : the two parts
    joint       : (xyz,) in the reference, mesh unit
    radius      : of the border, mesh unit
    drift       : of the joint in the take in which it drifts most, mesh unit
    """

    part: int
    above: int
    joint: Floats
    radius: float
    drift: float


class HiddenBone(NamedTuple):
    """A bone between two parts, as it moves, and its two joints.

    R, t         : (frame, 3, 3) · (frame, xyz) from the reference
    joint        : (side, xyz) about which it turns against the part above and the part below, in the reference, mesh unit
    drift        : (side,) of these joints, mesh unit
    widest_drift : (side,) the same in the take in which they drift most
    degrees      : (side,) range by which it turns against either side
    skin         : (follower,) vertices that follow it most, or nearly as much as any does
    area         : of the skin, each vertex by its weight, mesh unit²
    residual     : (frame,) root mean square of what is left unexplained where the skin follows it, mesh unit
    """

    R: Floats
    t: Floats
    joint: Floats
    drift: Floats
    widest_drift: Floats
    degrees: Floats
    skin: Ints
    area: float
    residual: Floats

    @property
    def ratio(self) -> Floats:
        """(side,) displacement of the other joint that turning about each gives, in drifts of this one."""
        length = np.linalg.norm(self.joint[1] - self.joint[0])
        moved: Floats = 2.0 * length * np.sin(np.radians(self.degrees) / 2.0)
        return moved / np.maximum(self.widest_drift, 1e-6 * length + np.finfo(float).tiny)


def hidden_bone(
    skin: MovingSkin, between: Border, settings: HiddenBonesSettings | None = None, takes: Sequence[slice] | None = None
) -> HiddenBone | None:
    """The bone between two parts, if there is one; None where one joint does.

    skin    : every vertex of it was followed
    between : the parts and the joint that they have without it
    takes   : positions of the frames of each take; None takes all as one
    """
    chosen, size = settings or HiddenBonesSettings(), float(np.sqrt(skin.area.sum()))
    if between.drift < 0.5 * chosen.drift * size:
        return None
    near = skin_around(skin, between, chosen)
    if len(near) < chosen.least_vertices:
        return None
    bone = _fitted(skin, between, near, score_spans(len(skin.x), takes), chosen)
    return bone if is_bone(bone, between, size, chosen) else None


def is_bone(bone: HiddenBone, between: Border, size: float, settings: HiddenBonesSettings) -> bool:
    """Whether two joints are needed, and the bone between them is one.

    size : root of the body's area, mesh unit
    """
    chosen, worst = settings, float(bone.widest_drift.max())
    needed = between.drift > chosen.drift * size or worst < chosen.less_drift * between.drift
    more = chosen.more_drift if between.drift > chosen.clear_drift * between.radius else 1.0
    length = float(np.linalg.norm(bone.joint[1] - bone.joint[0]))
    return bool(
        needed
        and bone.drift.max() < chosen.steady * size
        and worst < more * between.drift
        and length > chosen.apart * between.radius
        and bone.area > chosen.area * size**2
        and bone.degrees.min() > chosen.degrees
        and bone.ratio.min() > chosen.ratio
    )


def skin_around(skin: MovingSkin, between: Border, chosen: HiddenBonesSettings) -> Ints:
    """(near,) vertices near the joint that follow mostly the two parts."""
    away = np.linalg.norm(skin.V - between.joint, axis=1)
    both = skin.W[:, [between.above, between.part]].sum(axis=1)
    narrow = chosen.narrow * float(np.sqrt(skin.area.sum()))
    return np.flatnonzero((away < chosen.reach * max(between.radius, narrow)) & (both > chosen.skin))


def parts_around(skin: MovingSkin, between: Border, near: Ints, chosen: HiddenBonesSettings) -> Ints:
    """(part,) the part above, the part below, and the others that skin (near,) follows most."""
    others = [p for p in np.argsort(-skin.W[near].sum(axis=0), kind="stable") if p not in (between.above, between.part)]
    used = [p for p in others[: chosen.others] if skin.W[near, p].any()]
    return np.array([between.above, between.part, *used])


def _fitted(skin: MovingSkin, between: Border, near: Ints, spans: Ints, chosen: HiddenBonesSettings) -> HiddenBone:
    """The bone that explains the skin best, from two starts: half-way between the parts, and where they explain least.

    It is fitted to some vertices in some frames; its motion is then that of all frames, and all skin near it has weights.
    """
    parts, hold = parts_around(skin, between, near, chosen), (chosen.noise * float(np.sqrt(skin.area.sum()))) ** 2
    sample = near[np.linspace(0, len(near) - 1, min(chosen.most_vertices, len(near))).astype(np.int64)]
    some = slice(None, None, -(-len(skin.x) // chosen.most_frames))
    few = skin.of(sample, parts, some).weighed(hold)
    half = half_way(skin, between)
    starts = [(half[0][some], half[1][some]), few.least_explained(0.4 * between.radius)]
    found = min(
        (blended_bone(few.with_bone(*start, 0.5), hold, chosen.rounds) for start in starts),
        key=lambda fit: float(fit.squares().mean()),
    )
    sampled = refitted(skin.of(sample, parts, slice(None)).with_bone(*half, 0.0)._replace(W=found.W))
    whole = skin.of(near, parts, slice(None)).with_bone(sampled.R[:, -1], sampled.t[:, -1], 0.0).weighed(hold)
    joints = blend_joints(whole, np.full(2, between.radius), whole.bone_residual(), chosen.prior)
    return bone_of_skin(whole, near, joints, widest_blend_drift(whole, joints.rest, spans), spans, chosen)


def bone_of_skin(
    whole: MovingSkin, near: Ints, joints: Joints, widest: Floats, spans: Ints, chosen: HiddenBonesSettings
) -> HiddenBone:
    """The last part of some skin as a bone between the first two.

    near   : (vertex,) vertices that this skin has
    joints : with the first and the second part
    widest : (side,) drift of these in the span (span, 2) in which they drift most, mesh unit
    """
    own = whole.W[:, -1]
    degrees = np.array([widest_turning_range(whole.R[:, k].transpose(0, 2, 1) @ whole.R[:, -1], spans) for k in (0, 1)])
    follows = (own > 0.0) & (own >= np.minimum(whole.W[:, :-1].max(axis=1), chosen.follower * own.max()))
    motion = whole.R[:, -1], whole.t[:, -1]
    area, residual = float(whole.area @ own), whole.bone_residual()
    return HiddenBone(*motion, joints.rest, joints.drift, widest, degrees, near[follows], area, residual)


def blend_joints(fit: MovingSkin, radius: Floats, residual: Floats, prior: RotationCentresSettings) -> Joints:
    """About which points the last part turns against the first two: held amid the skin that follows both, by how well it fits.

    radius   : (side,) of the borders with the first and the second part, mesh unit
    residual : (frame,) what the motion of the last part leaves unexplained, mesh unit
    """
    last = fit.R.shape[1] - 1
    both = fit.area[:, None] * ((fit.W[:, :2] * fit.W[:, -1:]) ** 2 + 1e-12)
    centre = both.T @ fit.V / both.sum(axis=0)[:, None]
    level = np.full(fit.R.shape[:2], (residual**4).mean() ** 0.25)  # what few frames show counts
    return rotation_centres(fit.R, fit.t, np.array([[0, last], [1, last]]), centre, radius, level, None, prior)


def widest_blend_drift(fit: MovingSkin, joint: Floats, spans: Ints) -> Floats:
    """(side,) drift of the joints of `blend_joints` (side, xyz) in the span (span, 2) in which they drift most, mesh unit."""
    last = fit.R.shape[1] - 1
    return widest_drift(fit.R, fit.t, np.array([[0, last], [1, last]]), joint, spans)


def half_way(skin: MovingSkin, between: Border) -> tuple[Floats, Floats]:
    """(frame, 3, 3) · (frame, xyz) the motion half-way between the two parts, about their joint."""
    a, b = between.above, between.part
    turn = Rotation.from_matrix(skin.R[:, a].transpose(0, 2, 1) @ skin.R[:, b]).as_rotvec()
    R = skin.R[:, a] @ Rotation.from_rotvec(0.5 * turn).as_matrix()
    place = 0.5 * ((skin.R[:, a] + skin.R[:, b]) @ between.joint + skin.t[:, a] + skin.t[:, b])
    return R, place - R @ between.joint
