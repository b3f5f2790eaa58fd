"""Joints that an alignment smears away: proposed at the ends of limbs, judged on the frames' own surfaces (ours).

A ball of the foot that turns by 20° turns by 10° in aligned vertices, spread over the foot, so that no cut into rigid parts
can find it. The frames show it: with one more hinge the last part of the limb lies nearer to their surfaces. Every frame has a
surface of its own, so the hinge's turn in one frame agrees with that in the next only where something turns.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.end_cuts import EndCut, end_cuts
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings, confident_share
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFit, PiecePose, piece_fit, placed_piece
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints

FEWEST_PAIRS = 3
"""Pairs of frames that follow each other, below which nothing is said of a ring."""


class EndJointsSettings(NamedTuple):
    """What makes a joint. Chosen on wave, dance, ballet, wolf, people 0, 1, 5, 6, 7, four-legged 5, 6 and random trees 1, 6."""

    least_score: float = 0.026
    """Score of a ring (`ring_score`), at least. Of 15 true joints of these bodies 12 had more, up to 0.19; of rings where
    nothing turns one, a paw with 18 vertices on one side."""
    nearer: float = 4.0
    """Root mean square turn of the nearer piece against the part above, degrees, as `degrees`, at least: where it turns less it
    belongs to the part above, and the joint that is there lies at a wrong place. There it was 3.4° at most, at true joints
    6.1° or more."""
    degrees: float = 2.0
    """Root mean square turn that agrees from frame to frame, at least: that of a swing over 6°, which other joints need."""
    better: float = 0.98
    """What is left with another turn to start from, share of what is left without, at most. Not recorded."""
    most_frames: int = 40
    """Frames of each take in which rings are judged, about, evenly spread runs of two; for time."""
    points: int = 250
    """Points of a part, about; for time."""
    sample: int = 6000
    """Vertices that stand for a frame's surface; for time."""


class EndJoint(NamedTuple):
    """A joint within the last part of a limb, and how the piece beyond it moves.

    cut      : where it lies
    R, t     : (frame, 3, 3) · (frame, xyz) of the piece beyond, from the reference; of the whole part where it is not seen
    residual : (frame,) root mean square distance from the surface, mesh unit
    shown    : (frame,) whether the frame's surface shows the part
    score    : see `ring_score`
    """

    cut: EndCut
    R: Floats
    t: Floats
    residual: Floats
    shown: Flags
    score: float


class _Hinged(NamedTuple):
    """A ring in one frame: what is left of the part as one piece, and with the hinge, mesh unit² · the latter."""

    one: float
    two: float
    pose: PiecePose


def end_joints(
    body: MovingSurface,
    found: TreeJoints,
    confidence: Floats,
    surface: Callable[[int], tuple[Floats, Ints]],
    settings: EndJointsSettings | None = None,
) -> list[EndJoint]:
    """The joints that the frames show within the last parts of limbs, at most one in a part.

    confidence : (frame, vertex) 0 to 1
    surface    : gives a frame's mesh, V (source, xyz) mesh unit and F (face, corner), by its place among the frames
    """
    chosen = settings or EndJointsSettings()
    parents = found.left.part_tree.tree.parents
    cuts = list(end_cuts(body, found.label, parents, found.rest))
    if not cuts:
        return []
    share = confident_share(found.label, body.area, confidence, len(body.x), len(parents))
    shown = np.minimum(share, share[:, np.maximum(parents, 0)]) >= FramePosesSettings().seen
    pieces = _pieces(body, found, cuts, chosen.points)
    fits: list[dict[int, _Hinged]] = [{} for _ in cuts]
    judged, pairs = judged_frames(len(body.x), body.takes, chosen.most_frames)
    _fit(found, pieces, cuts, shown, surface, judged, fits, body.size, chosen)
    kept = _evident(body, found, cuts, fits, pairs, chosen)
    others = np.setdiff1d(np.arange(len(body.x)), judged)
    best = [k for k, _ in kept]
    some = [fits[k] for k in best]
    _fit(found, [pieces[k] for k in best], [cuts[k] for k in best], shown, surface, others, some, body.size, chosen)
    return [_joint(found, cuts[k], fits[k], score) for k, score in kept]


def judged_frames(count: int, takes: Sequence[slice] | None, most: int) -> tuple[Ints, Ints]:
    """Frames in which rings are judged, ascending · (pair, 2) which of them follow each other in one take.

    count : how many frames there are
    most  : how many of each take are judged, about; if it has more, runs of two
    """
    spans = [np.arange(count)[take] for take in takes or [slice(0, count)]]
    pairs = np.concatenate([_neighbours(span, most) for span in spans])
    return np.unique(pairs), pairs


def _neighbours(span: Ints, most: int) -> Ints:
    """(pair, 2) frames of a take that follow each other, evenly spread if it has more than `most` frames."""
    pairs = np.stack([span[:-1], span[1:]], axis=1)
    if len(span) > most and len(pairs):
        pairs = pairs[np.unique(np.linspace(0, len(pairs) - 1, most // 2).astype(np.int64))]
    return pairs


def ring_score(one: Floats, two: Floats, w: Floats, v: Floats) -> tuple[float, float]:
    """How clearly a hinge shows, and its root mean square turn that agrees from frame to frame, degrees.

    The score is by how much farther the part lies from the surfaces as one piece than with the hinge, share of the latter,
    times the correlation of the hinge's turn with that of the next frame: 1 for a slow turn, 0 for noise.

    one, two : (frame,) mean squared distance as one piece, with the hinge
    w, v     : (pair, xyz) turns about their mean in two frames that follow each other, radian
    """
    agreeing = max(float((w * v).sum(axis=1).mean()), 0.0)
    alike = agreeing / max(float((w**2 + v**2).sum(axis=1).mean()) / 2.0, 1e-300)
    gain = np.sqrt(one.sum() / max(two.sum(), 1e-300)) - 1.0
    return float(gain * alike), float(np.degrees(np.sqrt(agreeing)))


def _pieces(body: MovingSurface, found: TreeJoints, cuts: Sequence[EndCut], points: int) -> list[Piece]:
    """Points of every cut's part, those that follow it most with most weight."""
    N, pieces = smoothed_normals(body.V, body.F), []
    for cut in cuts:
        at = slice(None, None, max(len(cut.own) // points, 1))
        v = cut.own[at]
        mass = np.maximum(found.W[v, cut.part], 1e-3) ** 2
        pieces.append(Piece(body.V[v], N[v], mass, cut.far[at], cut.centre, found.rest[cut.part]))
    return pieces


def _fit(
    found: TreeJoints,
    pieces: Sequence[Piece],
    cuts: Sequence[EndCut],
    shown: Flags,
    surface: Callable[[int], tuple[Floats, Ints]],
    frames: Ints,
    fits: Sequence[dict[int, _Hinged]],
    size: float,
    chosen: EndJointsSettings,
) -> None:
    """Adds how the pieces lie in some frames to `fits`, frame by frame, so that each begins where it was last."""
    parents = found.left.part_tree.tree.parents
    for f in frames:
        if not any(shown[f, cut.part] for cut in cuts):
            continue
        V, F = surface(int(f))
        target, whole = Target.of(V, F, size, chosen.sample), {}
        for piece, cut, known in zip(pieces, cuts, fits, strict=True):
            p = cut.part
            if not shown[f, p]:
                continue
            goal = found.R[f, parents[p]] @ piece.joint + found.t[f, parents[p]]
            if p not in whole:
                whole[p] = _as_one(piece, PiecePose(found.R[f, p], found.t[f, p], np.eye(3)), goal, target)
            known[int(f)] = _hinged(piece, whole[p], goal, target, _nearest(known, int(f)), chosen)


def _as_one(piece: Piece, start: PiecePose, goal: Floats, target: Target) -> PieceFit:
    """The part as one piece."""
    y, n, _ = placed_piece(piece, start)
    return piece_fit(piece, start, goal, target, target.nearest(y, n), hinged=False)


def _hinged(
    piece: Piece, one: PieceFit, goal: Floats, target: Target, turn: Floats | None, chosen: EndJointsSettings
) -> _Hinged:
    """The part with the hinge, from where it lies as one piece, and with the turn of another frame if that is better."""
    best = piece_fit(piece, one.pose, goal, target, one.match, hinged=True)
    if turn is not None:
        start = one.pose._replace(Q=turn)
        y, n, _ = placed_piece(piece, start)
        other = piece_fit(piece, start, goal, target, target.nearest(y, n), hinged=True)
        if other.cost(piece.mass) < chosen.better * best.cost(piece.mass):
            best = other
    return _Hinged(one.cost(piece.mass), best.cost(piece.mass), best.pose)


def _nearest(known: dict[int, _Hinged], f: int) -> Floats | None:
    """(3, 3) the turn in the nearest frame that is known; None where none is."""
    return known[min(known, key=lambda g: (abs(g - f), g))].pose.Q if known else None


class _Evidence(NamedTuple):
    """What a ring shows over some frames: see `ring_score`; how many times more is left as one piece; turns, degrees."""

    score: float
    gain: float
    far: float
    near: float


def _evident(
    body: MovingSurface,
    found: TreeJoints,
    cuts: Sequence[EndCut],
    fits: Sequence[dict[int, _Hinged]],
    pairs: Ints,
    chosen: EndJointsSettings,
) -> list[tuple[int, float]]:
    """Of each part's rings with enough score the one that leaves least, if it turns enough, and its score.

    A part's rings are judged over all frames, or over those of the take in which one of them shows most.
    """
    spans, parents = score_spans(len(found.R), body.takes), found.left.part_tree.tree.parents
    rings: dict[int, dict[int, list[_Evidence]]] = {}
    for k, (cut, fit) in enumerate(zip(cuts, fits, strict=True)):
        rings.setdefault(cut.part, {})[k] = [_evidence(found.R[:, parents[cut.part]], fit, pairs, span) for span in spans]
    kept = []
    for _, shown in sorted(rings.items()):
        at = int(np.argmax([max(ring[s].score for ring in shown.values()) for s in range(len(spans))]))
        enough = [(ring[at].gain, k) for k, ring in shown.items() if ring[at].score >= chosen.least_score]
        if enough:
            k = max(enough)[1]
            turns = shown[k][at].far >= chosen.degrees and max(e.near for e in shown[k]) >= chosen.nearer
            kept += [(k, shown[k][at].score)] if turns else []
    return kept


def _evidence(above: Floats, fit: dict[int, _Hinged], pairs: Ints, span: Ints) -> _Evidence:
    """What a ring shows in the frames of a span; above (frame, 3, 3) the motion of the part above."""
    mine = {f: hinged for f, hinged in fit.items() if span[0] <= f < span[1]}
    both = np.array([(a, b) for a, b in pairs.tolist() if a in mine and b in mine], dtype=np.int64)
    if len(both) < FEWEST_PAIRS:
        return _Evidence(0.0, 0.0, 0.0, 0.0)
    far = about_mean({f: hinged.pose.Q for f, hinged in mine.items()})
    near = about_mean({f: above[f].T @ hinged.pose.R for f, hinged in mine.items()})
    one, two = (np.array([getattr(h, name) for h in mine.values()]) for name in ("one", "two"))
    score, degrees = ring_score(one, two, *(np.array([far[f] for f in side]) for side in both.T))
    _, nearer = ring_score(one, two, *(np.array([near[f] for f in side]) for side in both.T))
    return _Evidence(score, float(one.sum() / two.sum()), degrees, nearer)


def about_mean(turn: dict[int, Floats]) -> dict[int, Floats]:
    """By frame, rotations (3, 3) against their mean as vectors (xyz,), radian."""
    Q = Rotation.from_matrix(list(turn.values()))
    return dict(zip(turn, (Q.mean().inv() * Q).as_rotvec(), strict=True))


def _joint(found: TreeJoints, cut: EndCut, fit: dict[int, _Hinged], score: float) -> EndJoint:
    """The motion of the piece beyond a ring in all frames."""
    R, t, T = found.R[:, cut.part].copy(), found.t[:, cut.part].copy(), len(found.R)
    residual, shown = found.left.parts.residual[:, found.left.part_tree.tree.order[cut.part]].copy(), np.zeros(T, np.bool_)
    for f, hinged in fit.items():
        pose = hinged.pose
        R[f], shown[f], residual[f] = pose.R @ pose.Q, True, np.sqrt(hinged.two)
        t[f] = pose.R @ cut.centre + pose.t - R[f] @ cut.centre
    return EndJoint(cut, R, t, residual, shown, score)
