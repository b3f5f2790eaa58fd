"""Joints that an alignment smears away: proposed at the ends of limbs, judged on the frames' own surfaces (ours).

A ball of the foot that turns by 20° turns by 10° in aligned vertices, spread over the foot, so that no cut into rigid parts
can find it. The frames show it: with one more hinge the last part of the limb lies nearer to their surfaces. Every frame has a
surface of its own, so the hinge's turn in one frame agrees with that in the next only where something turns. Where frames are
too far apart for that, two halves of the piece beyond must turn alike in each of them.
"""

from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.end_cuts import EndCut
from kinetree.tasks.numerics.structure.end_rings import EndFrames, EndRing, Fits, lay_rings
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.hinged_piece import halves, laid_as_one, motions, turns_of_halves
from kinetree.tasks.numerics.structure.piece_fit import PiecePose
from kinetree.tasks.numerics.structure.ring_evidence import (
    RingEvidence,
    evidence_of_halves,
    going_on,
    judged_frames,
    ring_evidence,
)
from kinetree.tasks.numerics.structure.score_spans import score_spans

TOGETHER = 5
"""Frames that follow each other in which rings are judged together, at most; each begins with the turn of the one before."""


class EndJointsSettings(NamedTuple):
    """What makes a joint.

    Turns were chosen on wave, dance, ballet, wolf, people 0, 1, 5, 6, 7, four-legged 5, 6 and random trees 1, 6.
    """

    least_score: float = 0.006
    """Score of a ring (`ring_evidence`), at least. Chosen on wave, dance, ballet, wolf, people 0 to 19 and 60 to 69 and humans,
    four-legged and random trees 60 to 63: of 26 true joints the least had 0.0061 with straight hinges, rings where nothing
    turns 0.0032 at most. With bent ones two rings in hands of person 92 have 0.0050 and 0.0058, a true wrist 0.0055."""
    least_score_if_short: float = 0.0145
    """The same where the nearer piece is shorter than `slice_length`, as a neck is. On these bodies five true heads have 0.0164
    to 0.0263, two that shape gives as well 0.0117 and 0.0127; rings within heads, of people 86 to 99 too, and beside a foot of
    four-legged 0 have 0.0130 at most."""
    least_score_in_trunk: float = 0.05
    """The same across the trunk. Of 0.04, 0.05 and 0.06 chosen on 132 bodies (RESULTS, "The limit of rings across the trunk"):
    against 0.06 four more joints are found with 0.05 and none is false, with 0.04 three more yet, and five are false."""
    least_apart: float = 0.6
    """Distance of a ring across the trunk from the nearest of the part's joints, in radii of the ring, at least: the likeliest
    ring of a part that lies nearer says that the joint that is there is a little off."""
    least_apart_if_closer: float = 0.75
    """The same of rings that lie closer together, see `extended_tree`. Joints that these alone show lie at 1.07 to 1.58. Where
    nothing turns, within the chests of four-legged 4 and 60, rings at 0.67 and 0.66 score 0.0595 and 0.0566, those farther
    away 0.0465 at most. Chosen on the same bodies and on people 86 to 129, humans, four-legged and random trees 65 to 74."""
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
    nearer: float = 4.0
    """Root mean square turn of the nearer piece against the part above, degrees, as `degrees`, at least: where it turns less it
    belongs to the part above, and the joint that is there lies at a wrong place. There it was 3.4° at most, at true joints
    6.1° or more."""
    degrees: float = 2.0
    """Root mean square turn of the hinge that agrees from frame to frame, or by halves, at least: that of a swing over 6°,
    which other joints need."""
    slice_length: float = 2.1
    """Length of the nearer piece, from joint to ring, in radii of the ring, from which on it may turn less than the piece
    beyond turns against it. A shorter one that does is a slice of a joint that is there already, a little off. In a limb with
    a mirror image every shorter one is a slice: necks alone are as short. Chosen on people 5, 7, 14 to 18 and 20 in three
    takes: four such had 1.0 to 1.9, true joints with that turning 2.4 or more; in limbs with a mirror image true joints had
    2.6 to 5.2, two false ones 1.5 and 1.7."""
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
    """A ring, and how its part lies in the frames so far."""

    ring: EndRing
    fits: Fits

    def within(self, span: Ints) -> "_RingFits":
        """The same with the frames from the first to before the last of a span alone."""
        return self._replace(fits={f: fit for f, fit in self.fits.items() if span[0] <= f < span[1]})


def end_joints(
    frames: EndFrames,
    rings: Sequence[EndRing],
    judged: Sequence[Fits],
    takes: Sequence[slice] | None = None,
    mirrored: Collection[int] = (),
    settings: EndJointsSettings | None = None,
) -> list[EndJoint]:
    """The joints that the frames show within the last parts of limbs and within the trunk, at most one in a part.

    judged : by ring, how its part lies in the frames of `judged_frames`
    takes  : positions of the frames of each take, in order; None takes all as one
    mirrored : parts, in the tree's order, that end limbs with a mirror image
    """
    chosen, count = settings or EndJointsSettings(), len(frames.tree.R)
    at, pairs = judged_frames(count, takes, chosen.most_frames)
    laid = [_RingFits(ring, fits) for ring, fits in zip(rings, judged, strict=True)]
    evident = _one_beside_each_joint(frames.tree, _evident(frames, laid, pairs, score_spans(count, takes), mirrored, chosen))
    own = [one for one, _ in evident]
    lay_rings(frames, np.setdiff1d(np.arange(count), at), [one.ring for one in own], [one.fits for one in own])
    return [_joint(frames.tree, _usual(one, chosen), score) for one, score in evident]


def judged_runs(count: int, takes: Sequence[slice] | None, settings: EndJointsSettings | None = None) -> list[Ints]:
    """Frames in which rings are judged, of so many, in runs of a few that follow each other in one take."""
    chosen = settings or EndJointsSettings()
    frames, pairs = judged_frames(count, takes, chosen.most_frames)
    follows = np.isin(frames[1:], pairs[:, 1]) & (np.diff(frames) == 1)
    spans = np.split(frames, np.flatnonzero(~follows) + 1)
    return [span[k : k + TOGETHER] for span in spans for k in range(0, len(span), TOGETHER)]


def _evident(
    frames: EndFrames,
    laid: Sequence[_RingFits],
    pairs: Ints,
    spans: Ints,
    mirrored: Collection[int],
    chosen: EndJointsSettings,
) -> list[tuple[_RingFits, float]]:
    """Of each part's rings with enough score the likeliest one, if it turns enough, and its score.

    A part's rings are judged over all frames, or over those of the take in which one of them shows most.
    """
    table, evident = [_judged(frames, laid, pairs, span, chosen) for span in spans], []
    for part in sorted({one.ring.cut.part for one in laid}):
        own = [k for k, one in enumerate(laid) if one.ring.cut.part == part]
        best = table[int(np.argmax([max(row[k].score / _least(laid[k].ring, chosen) for k in own) for row in table]))]
        enough = [(_rank(laid[k].ring, best[k]), k) for k in own if best[k].score >= _least(laid[k].ring, chosen)]
        k = max(enough)[1] if enough else own[0]
        if enough and _is_joint(laid[k].ring, best[k], part in mirrored, chosen):
            evident.append((laid[k], best[k].score))
    return evident


def _one_beside_each_joint(tree: FirstTree, evident: Sequence[tuple[_RingFits, float]]) -> list[tuple[_RingFits, float]]:
    """The same with the best one of those rings across the trunk that have the same joint nearest to them.

    Where a joint that is there lies amid two true ones, both rings show one; once one of them is a joint, the other goes to its
    place.
    """
    best: dict[int, int] = {}
    for k, (one, score) in enumerate(evident):
        if one.ring.cut.hung:
            nearest = _nearest_joint(tree, one.ring.cut)
            if score > (evident[best[nearest]][1] if nearest in best else -np.inf):
                best[nearest] = k
    return [found for k, found in enumerate(evident) if not found[0].ring.cut.hung or k in best.values()]


def _nearest_joint(tree: FirstTree, cut: EndCut) -> int:
    """The joint of a ring's part that lies nearest to the ring, by the part that turns about it."""
    own = [k for k in (cut.part, *np.flatnonzero(tree.parents == cut.part).tolist()) if tree.parents[k] >= 0]
    return min(own, key=lambda k: float(np.linalg.norm(tree.rest[k] - cut.centre)))


def _rank(ring: EndRing, shown: RingEvidence) -> float:
    """How likely a ring is among those of its part: the less it leaves, since scores stay alike along a limb.

    Across the trunk, where rings come from several sides, by the score.
    """
    return shown.score if ring.cut.hung else shown.gain


def _least(ring: EndRing, chosen: EndJointsSettings) -> float:
    """The score that a ring needs."""
    if ring.cut.hung:
        return chosen.least_score_in_trunk
    return chosen.least_score_if_short if _is_short(ring, chosen) else chosen.least_score


def _is_short(ring: EndRing, chosen: EndJointsSettings) -> bool:
    """Whether the piece before the ring is short."""
    return bool(np.linalg.norm(ring.cut.centre - ring.piece.joint) < chosen.slice_length * ring.cut.radius)


def _is_joint(ring: EndRing, shown: RingEvidence, is_mirrored: bool, chosen: EndJointsSettings) -> bool:
    """Whether both pieces turn enough, and the nearer one is no slice of a joint that is there already."""
    is_clear = ring.cut.apart >= chosen.least_apart if ring.cut.hung else not _is_short(ring, chosen)
    is_slice = not is_clear and (bool(ring.cut.hung) or is_mirrored or shown.near < shown.far)
    return shown.far >= chosen.degrees and shown.near >= chosen.nearer and not is_slice


def _judged(
    frames: EndFrames, laid: Sequence[_RingFits], pairs: Ints, span: Ints, chosen: EndJointsSettings
) -> list[RingEvidence]:
    """What every ring shows in the frames of a span; its hinge is held where it shows enough even against one piece."""
    within, tree = [_usual(one.within(span), chosen) for one in laid], frames.tree
    pairs = pairs[(pairs >= span[0]).all(axis=1) & (pairs < span[1]).all(axis=1)]
    above = [tree.R[:, one.ring.cut.above] for one in laid]
    goes_on = going_on(tree.R, tree.parents, pairs, chosen.nearer) if len(pairs) else 1.0
    lasting, apart = goes_on >= chosen.goes_on, goes_on < chosen.halves_below
    evidence = [
        ring_evidence(R, one.fits, {f: fit.one for f, fit in one.fits.items()}, pairs, lasting=lasting)
        for R, one in zip(above, within, strict=True)
    ]
    clear = (1.0 + chosen.least_in_halves) ** 2
    at_ends = [not one.ring.cut.hung for one in laid]
    likely = [
        k
        for k, shown in enumerate(evidence)
        if shown.score >= _least(laid[k].ring, chosen) or (apart and at_ends[k] and shown.gain >= clear)
    ]
    mean = {k: _mean_turn(within[k].fits) for k in likely}
    steady = dict(zip(likely, _left_at(frames, [within[k] for k in likely], list(mean.values())), strict=True))
    for k in likely:
        evidence[k] = ring_evidence(above[k], within[k].fits, steady[k], pairs, lasting=lasting)
    by_halves = [k for k in likely if apart and at_ends[k]]
    turns = _turns_of_halves(frames, [within[k] for k in by_halves], [mean[k] for k in by_halves])
    for k, of_halves in zip(by_halves, turns, strict=True):
        shown = evidence_of_halves(evidence[k], above[k], within[k].fits, steady[k], of_halves)
        scaled = shown.score * _least(laid[k].ring, chosen) / chosen.least_in_halves
        if shown.score >= chosen.least_in_halves:
            evidence[k] = shown._replace(score=max(scaled, evidence[k].score))
    return evidence


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
