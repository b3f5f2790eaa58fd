"""Joints that an alignment smears away: proposed at the ends of limbs, judged on the frames' own surfaces (ours).

A ball of the foot that turns by 20° turns by 10° in aligned vertices, spread over the foot, so that no cut into rigid parts
can find it. The frames show it: with one more hinge the last part of the limb lies nearer to their surfaces. Every frame has a
surface of its own, so the hinge's turn in one frame agrees with that in the next only where something turns.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.end_cuts import EndCut, end_cuts
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings, confident_share
from kinetree.tasks.numerics.structure.hinged_piece import HingedFit, laid_as_one, laid_hinged, motions, sampled_piece
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFit, PiecePose
from kinetree.tasks.numerics.structure.ring_evidence import RingEvidence, judged_frames, ring_evidence
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints


class EndJointsSettings(NamedTuple):
    """What makes a joint.

    Turns were chosen on wave, dance, ballet, wolf, people 0, 1, 5, 6, 7, four-legged 5, 6 and random trees 1, 6.
    """

    least_score: float = 0.015
    """Score of a ring (`ring_evidence`), at least. Chosen on wave, dance, ballet, wolf and people 0, 1, 5, 6, 7, some at half
    and a quarter of their frame rate: of 13 true joints 12 had 0.016 to 0.087, rings where nothing turns 0.010 at most."""
    nearer: float = 4.0
    """Root mean square turn of the nearer piece against the part above, degrees, as `degrees`, at least: where it turns less it
    belongs to the part above, and the joint that is there lies at a wrong place. There it was 3.4° at most, at true joints
    6.1° or more."""
    degrees: float = 2.0
    """Root mean square turn that agrees from frame to frame, at least: that of a swing over 6°, which other joints need."""
    slice_length: float = 2.1
    """Length of the nearer piece, from joint to ring, in radii of the ring, from which on it may turn less than the piece
    beyond turns against it. A shorter one that does is a slice of a joint that is there already, a little off. Chosen on people
    5, 7, 14 to 18 and 20 in three takes: four such had 1.0 to 1.9, true joints with that turning 2.4 or more."""
    most_frames: int = 40
    """Frames of a take in which rings are judged in all of them; of more, in as many pairs of neighbours, in evenly spread runs
    of four frames, 52 in all; for time."""


class EndJoint(NamedTuple):
    """A joint within the last part of a limb, and how the piece beyond it moves.

    cut      : where it lies
    R, t     : (frame, 2, 3, 3) · (frame, 2, xyz) of the nearer piece and of that beyond, from the reference; of the whole part
               where it is not seen
    residual : (frame,) root mean square distance from the surface, mesh unit
    shown    : (frame,) whether the frame's surface shows the part
    score    : see `ring_evidence`
    """

    cut: EndCut
    R: Floats
    t: Floats
    residual: Floats
    shown: Flags
    score: float


class _Ring(NamedTuple):
    """A ring, points of its part, and how the part lies in the frames so far."""

    cut: EndCut
    piece: Piece
    fits: dict[int, HingedFit]

    def within(self, span: Ints) -> "_Ring":
        """The same with the frames from the first to before the last of a span alone."""
        return self._replace(fits={f: fit for f, fit in self.fits.items() if span[0] <= f < span[1]})


class _Frames(NamedTuple):
    """The tree, which frames show its parts (frame, part), their surfaces as in `end_joints`."""

    found: TreeJoints
    shown: Flags
    surface: Callable[[int], Target]

    def above(self, part: int) -> int:
        """The part on which a part hangs."""
        return int(self.found.left.part_tree.tree.parents[part])

    def goal(self, f: int, ring: _Ring) -> Floats:
        """(xyz,) where the rest of the body has the joint of a ring's part, mesh unit."""
        p = self.above(ring.cut.part)
        return np.asarray(self.found.R[f, p] @ ring.piece.joint + self.found.t[f, p])

    def showing(self, which: Iterable[int], rings: Sequence[_Ring]) -> Iterator[tuple[int, Target, list[int]]]:
        """Frames that show some of the rings' parts, their surfaces, and which rings these are."""
        for f in map(int, which):
            there = [k for k, ring in enumerate(rings) if self.shown[f, ring.cut.part]]
            if there:
                yield f, self.surface(f), there


def end_joints(
    body: MovingSurface,
    found: TreeJoints,
    confidence: Floats,
    surface: Callable[[int], Target],
    settings: EndJointsSettings | None = None,
) -> list[EndJoint]:
    """The joints that the frames show within the last parts of limbs, at most one in a part.

    confidence : (frame, vertex) 0 to 1
    surface    : gives a frame's surface, prepared, by its place among the frames
    """
    chosen = settings or EndJointsSettings()
    parents = found.left.part_tree.tree.parents
    rings = _rings(body, found, list(end_cuts(body, found.label, parents, found.rest)))
    share = confident_share(found.label, body.area, confidence, len(body.x), len(parents))
    shown = np.minimum(share, share[:, np.maximum(parents, 0)]) >= FramePosesSettings().seen
    frames = _Frames(found, shown, surface)
    judged, pairs = judged_frames(len(body.x), body.takes, chosen.most_frames)
    _lay(frames, judged, rings)
    evident = _evident(frames, rings, pairs, score_spans(len(body.x), body.takes), chosen)
    _lay(frames, np.setdiff1d(np.arange(len(body.x)), judged), [ring for ring, _ in evident])
    return [_joint(found, ring, score) for ring, score in evident]


def _rings(body: MovingSurface, found: TreeJoints, cuts: Sequence[EndCut]) -> list[_Ring]:
    """The rings with points of their parts."""
    N = smoothed_normals(body.V, body.F)
    return [
        _Ring(c, sampled_piece(body.V[c.own], N[c.own], found.W[c.own, c.part], c.far, c.centre, found.rest[c.part]), {})
        for c in cuts
    ]


def _lay(frames: _Frames, which: Ints, rings: Sequence[_Ring]) -> None:
    """Adds how the pieces lie in some frames, frame by frame, so that each begins where it was last."""
    R, t = frames.found.R, frames.found.t
    for f, target, there in frames.showing(which, rings):
        whole: dict[int, PieceFit] = {}
        for cut, piece, fits in (rings[k] for k in there):
            goal = frames.goal(f, _Ring(cut, piece, fits))
            if cut.part not in whole:
                start = PiecePose(R[f, cut.part], t[f, cut.part], np.eye(3))
                whole[cut.part] = laid_as_one(piece, start, goal, target)
            fits[f] = laid_hinged(piece, whole[cut.part], goal, target, _nearest(fits, f))


def _nearest(known: dict[int, HingedFit], f: int) -> Floats | None:
    """(3, 3) the turn in the nearest frame that is known; None where none is."""
    return known[min(known, key=lambda g: (abs(g - f), g))].pose.Q if known else None


def _evident(
    frames: _Frames, rings: Sequence[_Ring], pairs: Ints, spans: Ints, chosen: EndJointsSettings
) -> list[tuple[_Ring, float]]:
    """Of each part's rings with enough score the one that leaves least, if it turns enough, and its score.

    A part's rings are judged over all frames, or over those of the take in which one of them shows most.
    """
    table, kept = [_judged(frames, rings, pairs, span, chosen.least_score) for span in spans], []
    for part in sorted({ring.cut.part for ring in rings}):
        own = [k for k, ring in enumerate(rings) if ring.cut.part == part]
        best = table[int(np.argmax([max(row[k].score for k in own) for row in table]))]
        enough = [(best[k].gain, k) for k in own if best[k].score >= chosen.least_score]
        k = max(enough)[1] if enough else own[0]
        if enough and _is_joint(rings[k], best[k], chosen):
            kept.append((rings[k], best[k].score))
    return kept


def _is_joint(ring: _Ring, shown: RingEvidence, chosen: EndJointsSettings) -> bool:
    """Whether both pieces turn enough, and the nearer one is no slice of a joint that is there already."""
    length = float(np.linalg.norm(ring.cut.centre - ring.piece.joint))
    is_slice = length < chosen.slice_length * ring.cut.radius and shown.near < shown.far
    return shown.far >= chosen.degrees and shown.near >= chosen.nearer and not is_slice


def _judged(frames: _Frames, rings: Sequence[_Ring], pairs: Ints, span: Ints, least: float) -> list[RingEvidence]:
    """What every ring shows in the frames of a span; its hinge is held where it scores enough even against one piece."""
    within = [ring.within(span) for ring in rings]
    above = [frames.found.R[:, frames.above(ring.cut.part)] for ring in rings]
    told = [
        ring_evidence(R, ring.fits, {f: fit.one for f, fit in ring.fits.items()}, pairs)
        for R, ring in zip(above, within, strict=True)
    ]
    likely = [k for k, evidence in enumerate(told) if evidence.score >= least]
    for k, steady in zip(likely, _held(frames, [within[k] for k in likely]), strict=True):
        told[k] = ring_evidence(above[k], within[k].fits, steady, pairs)
    return told


def _held(frames: _Frames, rings: Sequence[_Ring]) -> list[dict[int, float]]:
    """By ring and frame, what is left of the part with the hinge held at its mean turn, mesh unit²."""
    mean = [Rotation.from_matrix([fit.pose.Q for fit in ring.fits.values()]).mean().as_matrix() for ring in rings]
    left: list[dict[int, float]] = [{} for _ in rings]
    for f, target, there in frames.showing(sorted({f for ring in rings for f in ring.fits}), rings):
        for k in there:
            ring = rings[k]
            start = ring.fits[f].pose._replace(Q=mean[k])
            left[k][f] = laid_as_one(ring.piece, start, frames.goal(f, ring), target).cost(ring.piece.mass)
    return left


def _joint(found: TreeJoints, ring: _Ring, score: float) -> EndJoint:
    """The motion of the pieces on both sides of a ring in all frames."""
    cut = ring.cut
    R, t = (np.repeat(a[:, cut.part, None], 2, axis=1) for a in (found.R, found.t))
    residual = found.left.parts.residual[:, found.left.part_tree.tree.order[cut.part]].copy()
    shown = np.zeros(len(R), np.bool_)
    for f, hinged in ring.fits.items():
        shown[f], residual[f] = True, np.sqrt(hinged.two)
        R[f], t[f] = motions(hinged.pose, cut.centre)
    return EndJoint(cut, R, t, residual, shown, score)
