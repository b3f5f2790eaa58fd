"""Joints that an alignment smears away: proposed at the ends of limbs, judged on the frames' own surfaces (ours).

A ball of the foot that turns by 20° turns by 10° in aligned vertices, spread over the foot, so that no cut into rigid parts
can find it. The frames show it: with one more hinge the last part of the limb lies nearer to their surfaces. Every frame has a
surface of its own, so the hinge's turn in one frame agrees with that in the next only where something turns. Where frames are
too far apart for that, two halves of the piece beyond must turn alike in each of them.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.end_cuts import EndCut
from kinetree.tasks.numerics.structure.end_rings import EndFrames, EndRing, Fits, lay_rings
from kinetree.tasks.numerics.structure.evident_rings import EvidentRingsSettings, evident_rings, needed_score
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.hinged_piece import halves, laid_as_one, motions, turns_of_halves
from kinetree.tasks.numerics.structure.inertia import Turns, beyond_inertia, inertial_turns
from kinetree.tasks.numerics.structure.piece_fit import PiecePose
from kinetree.tasks.numerics.structure.ring_evidence import (
    RingEvidence,
    about_mean,
    evidence_of_halves,
    going_on,
    judged_frames,
    ring_evidence,
)
from kinetree.tasks.numerics.structure.score_spans import score_spans

TOGETHER = 5
"""Frames that follow each other in which rings are judged together, at most; each begins with the turn of the one before."""


class EndJointsSettings(NamedTuple):
    """What makes a joint."""

    evident: EvidentRingsSettings = EvidentRingsSettings()
    """Which rings are joints."""
    goes_on: float = 0.5
    """How much of the turn of the body's joints goes on from frame to frame (`going_on`), below which the frames are too far
    apart for a ring's turn to go on to the frame after the next. All frames of recorded bodies and of people 0 to 7 have 0.73
    to 0.97, every fourth of wave, dance and wolf −0.10 to 0.48, of ballet 0.61 to 0.79."""
    halves_below: float = 0.7
    """The same, below which a ring at an end may show its turn in halves instead. Fifteen people at 6 frames a second have 0.02
    to 0.83; with 0.5 two balls of feet of theirs are lost."""
    least_in_halves: float = 0.03
    """Score by two halves of the points beyond a ring (`evidence_of_halves`) that is asked for there, at least. Chosen on every
    fourth frame of wave, dance and wolf and on people 55 to 69 at 6 frames a second: in these 27 runs five joints fewer are
    found with 0.04; with 0.024 two more are, and two false ones."""
    most_left: float = 2.0
    """Root mean square distance that a part with its hinge may keep from a frame's surface, in its median over the take's
    frames: what keeps more is touched or hidden there, and the frame says nothing of it. A hand that rests on a hip keeps 2.5
    times as much."""
    little_left: float = 0.1
    """Distance that no part is refused for, in radii of the ring."""
    most_frames: int = 40
    """Frames of a take in which rings are judged in all of them; of more, in as many pairs of neighbours, in evenly spread runs
    of four frames, 52 in all; for time."""


class EndJoint(NamedTuple):
    """A joint within the last part of a limb or within the trunk, and how the pieces on both sides of it move.

    cut      : where it lies
    R, t     : (frame, 2, 3, 3) · (frame, 2, xyz) of the nearer piece and of that beyond, from the reference; of the whole part
               where it is not seen
    residual : (frame,) root mean square distance from the surface, mesh unit
    visible  : (frame,) whether the frame's surface shows the part
    score    : see `ring_evidence`; by halves, times what the ring needs / `least_in_halves`
    """

    cut: EndCut
    R: Floats
    t: Floats
    residual: Floats
    visible: Flags
    score: float


class _RingFits(NamedTuple):
    """A ring, and how its part lies in the frames so far.

    inertia : how flesh that stays behind would turn its hinge; none where that is not asked
    """

    ring: EndRing
    fits: Fits
    inertia: Turns

    def within(self, span: Ints) -> "_RingFits":
        """The same with the frames from the first to before the last of a span alone."""
        return self._replace(fits={f: fit for f, fit in self.fits.items() if span[0] <= f < span[1]})


def end_joints(
    frames: EndFrames,
    rings: Sequence[EndRing],
    judged: Sequence[Fits],
    takes: Sequence[slice] | None = None,
    settings: EndJointsSettings | None = None,
) -> list[EndJoint]:
    """The joints that the frames show within the last parts of limbs and within the trunk: at most one in a part, but two in
    one that holds both limbs of a pair.

    judged : by ring, how its part lies in the frames of `judged_frames`
    takes  : positions of the frames of each take, in order; None takes all as one
    """
    chosen, count = settings or EndJointsSettings(), len(frames.tree.R)
    at, pairs = judged_frames(count, takes, chosen.most_frames)
    laid = [_RingFits(ring, fits, _inertia(frames.tree, ring, takes)) for ring, fits in zip(rings, judged, strict=True)]
    table = [_judged(frames, laid, pairs, span, chosen) for span in score_spans(count, takes)]
    evident = evident_rings(frames.tree, rings, table, chosen.evident)
    own = [laid[k] for k in evident]
    lay_rings(frames, np.setdiff1d(np.arange(count), at), [one.ring for one in own], [one.fits for one in own])
    joints = [_joint(frames.tree, _usual(laid[k], chosen), score) for k, score in evident.items()]
    return _with_common_pieces(joints)


def judged_runs(count: int, takes: Sequence[slice] | None, settings: EndJointsSettings | None = None) -> list[Ints]:
    """Frames in which rings are judged, of so many, in runs of a few that follow each other in one take."""
    chosen = settings or EndJointsSettings()
    frames, pairs = judged_frames(count, takes, chosen.most_frames)
    follows = np.isin(frames[1:], pairs[:, 1]) & (np.diff(frames) == 1)
    spans = np.split(frames, np.flatnonzero(~follows) + 1)
    return [span[k : k + TOGETHER] for span in spans for k in range(0, len(span), TOGETHER)]


def _judged(
    frames: EndFrames, laid: Sequence[_RingFits], pairs: Ints, span: Ints, chosen: EndJointsSettings
) -> list[RingEvidence]:
    """What every ring shows in the frames of a span; its hinge is held where it shows enough even against one piece."""
    within, tree = [_usual(one.within(span), chosen) for one in laid], frames.tree
    pairs = pairs[(pairs >= span[0]).all(axis=1) & (pairs < span[1]).all(axis=1)]
    above = [tree.R[:, one.ring.cut.above] for one in laid]
    goes_on = going_on(tree.R, tree.parents, pairs, chosen.evident.nearer) if len(pairs) else 1.0
    lasting, apart = goes_on >= chosen.goes_on, goes_on < chosen.halves_below
    own = [_share_beyond_inertia(one, pairs) if lasting else 1.0 for one in within]
    evidence = [
        ring_evidence(R, one.fits, {f: fit.one for f, fit in one.fits.items()}, pairs, lasting=lasting).times(share)
        for R, one, share in zip(above, within, own, strict=True)
    ]
    clear = (1.0 + chosen.least_in_halves) ** 2
    at_ends = [not one.ring.cut.hung for one in laid]
    likely = [
        k
        for k, shown in enumerate(evidence)
        if shown.score >= needed_score(laid[k].ring, chosen.evident) or (apart and at_ends[k] and shown.gain >= clear)
    ]
    mean = {k: _mean_turn(within[k].fits) for k in likely}
    steady = dict(zip(likely, _left_at(frames, [within[k] for k in likely], list(mean.values())), strict=True))
    for k in likely:
        evidence[k] = ring_evidence(above[k], within[k].fits, steady[k], pairs, lasting=lasting).times(own[k])
    by_halves = [k for k in likely if apart and at_ends[k]]
    turns = _turns_of_halves(frames, [within[k] for k in by_halves], [mean[k] for k in by_halves])
    for k, of_halves in zip(by_halves, turns, strict=True):
        shown = evidence_of_halves(evidence[k], above[k], within[k].fits, steady[k], of_halves)
        scaled = shown.score * needed_score(laid[k].ring, chosen.evident) / chosen.least_in_halves
        if shown.score >= chosen.least_in_halves:
            evidence[k] = shown._replace(score=max(scaled, evidence[k].score))
    return evidence


def _inertia(tree: FirstTree, ring: EndRing, takes: Sequence[slice] | None) -> Turns:
    """How flesh that stays behind would turn a ring's hinge; asked at the ends of limbs with a mirror image alone."""
    if not ring.is_mirrored:
        return {}
    (cut, piece, _), R, t = ring, tree.R[:, ring.cut.part], tree.t[:, ring.cut.part]
    return inertial_turns(piece.V.mean(axis=0), cut.centre - piece.joint, R, t, takes)


def _share_beyond_inertia(laid: _RingFits, pairs: Ints) -> float:
    """Share of a hinge's turn that inertia does not explain."""
    if not laid.inertia or not laid.fits:
        return 1.0
    return beyond_inertia(about_mean({f: fit.pose.Q for f, fit in laid.fits.items()}), laid.inertia, pairs)


def _usual(laid: _RingFits, chosen: EndJointsSettings) -> _RingFits:
    """The ring without the frames in which its part lies badly even with its hinge: there something touches or hides it."""
    if not laid.fits:
        return laid
    usual = float(np.sqrt(np.median([fit.two for fit in laid.fits.values()])))
    most = max(chosen.most_left * usual, chosen.little_left * laid.ring.cut.radius) ** 2
    return laid._replace(fits={f: fit for f, fit in laid.fits.items() if fit.two <= most})


def _mean_turn(fits: Fits) -> Floats:
    """(3, 3) mean turn of a hinge."""
    return np.asarray(Rotation.from_matrix([fit.pose.Q for fit in fits.values()]).mean().as_matrix())


def _left_at(frames: EndFrames, laid: Sequence[_RingFits], held: Sequence[Floats]) -> list[dict[int, float]]:
    """By ring and frame, what is left of the part with the hinge held at a turn (3, 3), mesh unit²."""
    left: list[dict[int, float]] = [{} for _ in laid]
    for k, f, start, target in _laid_in_frames(frames, laid, held):
        piece = laid[k].ring.piece
        left[k][f] = laid_as_one(piece, start, frames.goal(f, laid[k].ring), target).cost(piece.mass)
    return left


def _turns_of_halves(
    frames: EndFrames, laid: Sequence[_RingFits], begin: Sequence[Floats]
) -> list[dict[int, tuple[Floats, Floats]]]:
    """By ring and frame, the turn of the hinge by each half of the points beyond it; both begin with the same (3, 3)."""
    turns: list[dict[int, tuple[Floats, Floats]]] = [{} for _ in laid]
    both = [halves(one.ring.piece) for one in laid]
    for k, f, start, target in _laid_in_frames(frames, laid, begin):
        turns[k][f] = turns_of_halves(both[k], start, frames.goal(f, laid[k].ring), target)
    return turns


def _laid_in_frames(
    frames: EndFrames, laid: Sequence[_RingFits], turn: Sequence[Floats]
) -> Iterator[tuple[int, int, PiecePose, Target]]:
    """Ring, frame, where the part lies in it but for the hinge, which has this turn (3, 3), and the frame's surface."""
    for f, target, there in frames.showing(sorted({f for one in laid for f in one.fits}), [one.ring for one in laid]):
        for k in there:
            if f in laid[k].fits:
                yield k, f, laid[k].fits[f].pose._replace(Q=turn[k]), target


def _joint(tree: FirstTree, laid: _RingFits, score: float) -> EndJoint:
    """The motion of the pieces on both sides of a ring in all frames."""
    cut = laid.ring.cut
    R, t = (np.repeat(a[:, cut.part, None], 2, axis=1) for a in (tree.R, tree.t))
    residual, visible = tree.unexplained[:, cut.part].copy(), np.zeros(len(R), np.bool_)
    for f, hinged in laid.fits.items():
        visible[f], residual[f] = True, np.sqrt(hinged.two)
        R[f], t[f] = motions(hinged.pose, cut.centre)
    return EndJoint(cut, R, t, residual, visible, score)


def _with_common_pieces(joints: Sequence[EndJoint]) -> list[EndJoint]:
    """The same, where rings across both limbs of a pair agree how the piece between them moves.

    In every frame it moves as the clearer ring has it, the later one, or the other where the frame does not show that one.
    """
    out = list(joints)
    for k in range(1, len(out)):
        one, other = out[k - 1], out[k]
        if one.cut.is_across_limb and other.cut.is_across_limb and one.cut.part == other.cut.part:
            by_one = one.visible & ~other.visible
            R = np.where(by_one[:, None, None], one.R[:, 1], other.R[:, 1])
            t = np.where(by_one[:, None], one.t[:, 1], other.t[:, 1])
            residual = np.where(by_one, one.residual, other.residual)
            for place, joint in ((k - 1, one), (k, other)):
                new_R, new_t = joint.R.copy(), joint.t.copy()
                new_R[:, 1], new_t[:, 1] = R, t
                out[place] = joint._replace(R=new_R, t=new_t, residual=residual)
    return out
