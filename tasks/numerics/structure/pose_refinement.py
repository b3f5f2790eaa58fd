"""The finished body fitted to the surface of one frame, where the pose so far is in doubt (2014, Sec. 7.3).

E = Σ across the surface, both ways (`matches`) + α Σ trust² |x_v − aligned_v|² + Σ_a firm_a |log(turn_a expected_aᵀ)|²,
by Gauss–Newton over the turns of all parts and the root's shift, bones of fixed length, from wide to narrow. A part of which
nothing is seen is held where it was expected; the more its surface says, the less.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_fit import turns
from kinetree.tasks.numerics.structure.articulated_frame import Body, Posture, against_parents, chained, joints, pulled
from kinetree.tasks.numerics.structure.frame_poses import SEEN
from kinetree.tasks.numerics.structure.pose_hypotheses import guess
from kinetree.tasks.numerics.structure.surface_matches import Matches, Rows, followed, rows, shown, sought, unexplained

DOUBT = 0.7  # confidence of a part below which a frame is fitted
GAIN = 0.03  # share of what was left unexplained that a fit must explain
STRANGE = np.deg2rad(60.0)  # no part turns farther than this from every turn it was seen in, unless it did already
SURFACE = 0.7  # what a part is believed that the surface alone shows in full; it says little of turns about a limb's own axis

SIGMA = (0.1, 0.06, 0.036, 0.022, 0.015, 0.012, 0.012, 0.012)  # where a match counts a quarter, shares of the body's size
SEARCH = 2  # every so many steps matches are sought everywhere
SLACK = 0.05  # ways along the surface against ways across it
ALIGNED = 0.5  # α: aligned vertices against the surface
FAINT = 0.5  # trust below which an aligned vertex says nothing
HARDLY = 0.3  # confidence of a part below which its aligned vertices count less
HOLD, ALONE = 0.002, 0.02  # what is expected against a part's surface: seen in full, and beside that where nothing is
DAMPING = 1e-6
STEP = 0.5  # radians


class Known(NamedTuple):
    """What the sequence says of all poses.

    R          : (frame, part, 3, 3) from rest to each frame
    confidence : (frame, part) 0 to 1
    """

    R: Floats
    confidence: Floats


class Fitted(NamedTuple):
    """A frame's posture.

    moved         : whether it is another than the one so far
    at            : the posture
    confidence    : (part,) 0 to 1
    before, after : share of the frame's surface that the posture so far and this one leave unexplained
    """

    moved: bool
    at: Posture
    confidence: Floats
    before: float
    after: float


def doubtful(confidence: Floats) -> Flags:
    """(…,) whether a frame needs a fit, from the confidence (…, part) of its parts."""
    return np.asarray((confidence < DOUBT).any(axis=-1))


def refined_pose(
    body: Body, start: Posture, target: Target, aligned: Floats, trust: Floats, known: Known, frame: int
) -> Fitted:
    """The posture that explains the frame better than the one so far by a margin, or that one.

    start          : the posture so far
    target         : the frame
    aligned, trust : (vertex, xyz) where each vertex is believed to be, mesh unit · (vertex,) 0 to 1
    known, frame   : all poses so far · the row of this one
    """
    first = sought(body, start, target)
    before = float(unexplained(body, target, first).mean())
    expected = against_parents(start.R, body.parents)
    trust = believed(body, trust, known.confidence[frame])
    best = refined(body, start, target, aligned, trust, expected)
    found = sought(body, best, target)
    turn, seen = against_parents(known.R, body.parents), _seen(known.confidence, body.parents)
    lost = _out_of_sight(body, known.confidence[frame], shown(body, target, found))
    other = guess(body, best, target, found, turn, seen, frame, lost)
    if other is not None:
        other = refined(body, other, target, aligned, trust, against_parents(other.R, body.parents))
        there = sought(body, other, target)
        if unexplained(body, target, there).mean() < unexplained(body, target, found).mean():
            best, found = other, there
    strange = _strange(best, start, body.parents, turn, seen)
    if strange.any():
        kept = np.where((strange @ body.beyond)[:, None, None], expected, against_parents(best.R, body.parents))
        best = Posture(chained(kept, body.parents), best.x)
        found = sought(body, best, target)
    after = float(unexplained(body, target, found).mean())
    if after > (1.0 - GAIN) * before:
        return Fitted(False, start, known.confidence[frame], before, before)
    above = np.maximum(body.parents, 0)
    share = shown(body, target, found)
    confidence = np.maximum(known.confidence[frame], SURFACE * np.minimum(share, share[above]) ** 2)
    return Fitted(True, best, confidence, before, after)


def refined(body: Body, start: Posture, target: Target, aligned: Floats, trust: Floats, expected: Floats) -> Posture:
    """The posture that explains the frame's surface best, from a posture not too far.

    trust    : (vertex,) weight of the aligned vertices
    expected : (part, 3, 3) turns against the parents, the root's in space
    """
    at, found = start, None
    for step, sigma in enumerate(SIGMA):
        found = sought(body, at, target) if found is None or step % SEARCH == 0 else followed(body, at, target, found)
        said = rows(body, target, found, sigma * body.size, SLACK)
        at = _stepped(body, at, said, _aligned(body, found, aligned, trust), expected)
    return at


def _stepped(body: Body, at: Posture, said: Rows, aligned: Rows, expected: Floats) -> Posture:
    count = len(body.parents)
    H, g = np.zeros((3 * count + 3, 3 * count + 3)), np.zeros(3 * count + 3)
    R, X = np.ascontiguousarray(at.R), joints(body, at)
    for drawn in (said, aligned):
        pulled(H, g, *drawn, body.V, body.bound, body.weight, body.rest, body.parents, R, X)
    _hold(H, g, R, body.parents, expected, body.reach * (HOLD + ALONE * (1.0 - heard(body, said)) ** 2))
    H[-3:, :-3] = H[:-3, -3:].T
    diagonal = np.arange(len(g))
    H[diagonal, diagonal] += DAMPING * np.trace(H) / len(g)
    move: Floats = np.linalg.solve(H, g).astype(np.float64)
    omega = move[:-3].reshape(count, 3)
    share = min(1.0, STEP / max(float(np.linalg.norm(omega, axis=1).max()), 1e-12))
    return Posture(turns(share * omega) @ R, at.x + share * move[-3:])


def believed(body: Body, trust: Floats, confidence: Floats) -> Floats:
    """(vertex,) weight of the aligned vertices: faint trust is none, and a part that is hardly seen has none worth trusting.

    At the edge of a lost limb are vertices that the flesh around it has drawn to itself.
    """
    clear = np.clip((trust - FAINT) / (1.0 - FAINT), 0.0, 1.0) ** 2
    weight: Floats = clear * np.minimum(confidence / HARDLY, 1.0)[body.label] ** 2
    return weight


def heard(body: Body, said: Rows) -> Floats:
    """(part,) 0 to 1: how much of each part's surface the frame speaks of, whichever way says more."""
    count, asked = len(body.parents), len(body.asked)
    part = body.label[said.vertex]
    ways = [np.bincount(part[way], said.plane[way], count) for way in (slice(asked), slice(asked, None))]
    whole = np.maximum(np.bincount(body.label[body.asked], body.mass, count), 1e-300)
    return np.minimum(np.maximum(*ways) / whole, 1.0)


def _aligned(body: Body, found: Matches, aligned: Floats, trust: Floats) -> Rows:
    """The aligned vertices, in all directions alike."""
    a = body.asked
    d = aligned[a] - found.x[a]
    weight = ALIGNED * body.mass * trust[a]
    return Rows(a, d, np.zeros_like(d), np.zeros(len(a)), weight)


def _hold(H: Floats, g: Floats, R: Floats, parents: Ints, expected: Floats, firm: Floats) -> None:
    """Adds firm |log(R_p expected R_aᵀ)|² for every part a."""
    above = R[np.maximum(parents, 0)]
    above[0] = np.eye(3)
    M = above @ expected @ R.transpose(0, 2, 1)
    away = np.stack([M[:, 2, 1] - M[:, 1, 2], M[:, 0, 2] - M[:, 2, 0], M[:, 1, 0] - M[:, 0, 1]], axis=1) / 2
    for a, p in enumerate(parents):
        block, i = firm[a] * np.eye(3), slice(3 * a, 3 * a + 3)
        H[i, i] += block
        g[i] += firm[a] * away[a]
        if p >= 0:
            j = slice(3 * p, 3 * p + 3)
            H[j, j] += block
            H[i, j] -= block
            H[j, i] -= block
            g[j] -= firm[a] * away[a]


def _out_of_sight(body: Body, confidence: Floats, share: Floats) -> Flags:
    """(part,) parts in doubt that the frame does not show where they are, and all that hangs on them; never the root."""
    first = (confidence < DOUBT) & (share < SEEN)
    first[0] = False
    return np.asarray(first @ body.beyond)


def _seen(confidence: Floats, parents: Ints) -> Flags:
    """(frame, part) frames whose turning serves others: the part and its parent were seen."""
    seen: Flags = np.minimum(confidence, confidence[:, np.maximum(parents, 0)]) >= SEEN
    return seen


def _strange(at: Posture, start: Posture, parents: Ints, turn: Floats, seen: Flags) -> Flags:
    """(part,) parts that turn as they were seen nowhere, and did not before."""
    strange = np.zeros(len(parents), np.bool_)
    new, old = (against_parents(p.R, parents) for p in (at, start))
    for a in range(1, len(parents)):
        ways = turn[seen[:, a], a]
        if len(ways):
            far, was = (_angles(ways, p[a]).min() for p in (new, old))
            strange[a] = far > max(STRANGE, was)
    return strange


def _angles(ways: Floats, R: Floats) -> Floats:
    """(way,) radians between rotations."""
    cosine = (np.einsum("kxy,xy->k", ways, R) - 1.0) / 2.0
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))
