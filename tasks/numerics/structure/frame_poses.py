"""A pose for every frame, also where a limb touches or is lost, and the confidence of each (2014, Sec. 7.3; ours).

Parts whose surface is certain are fitted. Where little of a part is, its rotation against its parent is held to that of the
frames around in which it was seen, interpolated on the shortest way from the one to the other.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import Motion, PosePrior, fitted, predicted, sums


class FramePosesSettings(NamedTuple):
    """How poses are fitted and weighed."""

    seen: float = 0.5
    """Share of a part's surface that must be certain for its pose to serve other frames. Not recorded."""
    hold: float = 0.3
    """Weight of the frames around, where nothing of a part is seen, against a part seen in full. Not recorded."""
    sample: int = 250
    """Vertices of a part that a fit uses, about. Not recorded; for time."""
    margin: float = 0.02
    """Error of a part, share of the root of the area, at which its pose has half the confidence. Not recorded."""


class FramePoses(NamedTuple):
    """Every frame's pose.

    motion     : rotations of all parts and positions of the root
    error      : (frame, part) root mean square distance of a part's vertices to the model, weighted by confidence, mesh unit
    confidence : (frame, part) 0 to 1: how much of the part and of its parent was seen, and how well they fit
    """

    motion: Motion
    error: Floats
    confidence: Floats


def frame_poses(
    V: Floats,
    x: Floats,
    area: Floats,
    label: Ints,
    W: Floats,
    start: Motion,
    parents: Ints,
    confidence: Floats | None = None,
    settings: FramePosesSettings | None = None,
    expected: Floats | None = None,
    takes: Sequence[slice] | None = None,
) -> FramePoses:
    """Fits the finished body to every frame.

    V, x       : (vertex, xyz), (frame, vertex, xyz) mesh unit
    area       : (vertex,) mesh unit²
    label      : (vertex,) part, W : (vertex, part) skinning weights
    start      : joints, and poses to start from
    parents    : (part,) −1 for the root
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    expected   : (frame, part, 3, 3) rotation against its parent at which a part is held that a frame does not show; None
                 interpolates between the frames that do
    takes      : positions of the frames of each take, across which nothing is interpolated; None takes all as one
    """
    chosen = settings or FramePosesSettings()
    share = area / area.sum()
    seen = confident_share(label, share, confidence, len(x), len(parents))
    sample, mass = fit_sample(label, share, len(parents), chosen.sample)
    if confidence is None:
        motion = fitted(sums(V[sample], x[:, sample], W[sample], parents, mass), start, parents)
    else:
        s = sums(V[sample], x[:, sample], W[sample], parents, mass * np.maximum(confidence[:, sample], 1e-6))
        free = fitted(s, start, parents, _prior(start, V, label, share, parents, seen, chosen, expected, takes))
        motion = fitted(s, free, parents, _prior(free, V, label, share, parents, seen, chosen, expected, takes))
    weight = np.ones(x.shape[:2]) if confidence is None else confidence
    square = weight * ((predicted(V, W, motion, parents) - x) ** 2).sum(axis=2)
    error = np.sqrt(
        _by_part(square, label, share, len(parents)) / np.maximum(_by_part(weight, label, share, len(parents)), 1e-12)
    )
    fit = seen / (1.0 + (error / (chosen.margin * np.sqrt(area.sum()))) ** 2)
    above = np.maximum(parents, 0)
    return FramePoses(motion, error, np.clip(np.minimum(fit, fit[:, above]), 0.0, 1.0))


def fit_sample(label: Ints, area: Floats, parts: int, count: int | None = None) -> tuple[Ints, Floats]:
    """Vertices that a fit uses, evenly many of every part, and the area of each: together their part's whole area.

    label, area : (vertex,) part · any unit
    parts       : how many there are
    count       : vertices of a part, about; as many as `FramePosesSettings` has if not given
    returns     : (sample,) vertices, ascending · (sample,) area
    """
    order = np.argsort(label, kind="stable")
    size = np.bincount(label, minlength=parts)
    rank = np.arange(len(label)) - np.repeat(np.cumsum(size) - size, size)
    every = -(-size // (count or FramePosesSettings().sample))
    sample = np.sort(order[rank % np.repeat(np.maximum(every, 1), size) == 0])
    whole, held = (np.bincount(label[v], area[v], parts) for v in (np.arange(len(label)), sample))
    return sample, area[sample] * (whole / np.maximum(held, 1e-300))[label[sample]]


def confident_share(label: Ints, area: Floats, confidence: Floats | None, frames: int, parts: int) -> Floats:
    """Share of each part's surface that is certain: mean confidence of its vertices, by area.

    label, area   : (vertex,) part · any unit
    confidence    : (frame, vertex) 0 to 1; None where all are certain
    frames, parts : how many there are
    returns       : (frame, part) 0 to 1
    """
    if confidence is None:
        return np.ones((frames, parts))
    return np.clip(_by_part(confidence, label, area, parts) / np.maximum(np.bincount(label, area, parts), 1e-300), 0.0, 1.0)


def interpolated(turn: Floats, known: Flags) -> Floats:
    """Rotations, interpolated on the shortest way between the nearest known frames; beyond the last known the nearest.

    turn    : (frame, 3, 3)
    known   : (frame,) which of them are known; where none is, all stay as they are
    returns : (frame, 3, 3)
    """
    at = np.flatnonzero(known)
    if not len(at) or len(at) == len(known):
        return turn
    out = turn.copy()
    frame = np.arange(len(known))
    after = np.minimum(np.searchsorted(at, frame), len(at) - 1)
    before = np.maximum(np.searchsorted(at, frame, side="right") - 1, 0)
    for f in np.flatnonzero(~known):
        a, b = at[before[f]], at[after[f]]
        share = np.clip((f - a) / (b - a), 0.0, 1.0) if b > a else 0.0
        out[f] = turn[a] @ _power(turn[a].T @ turn[b], float(share))
    return out


def _prior(
    motion: Motion,
    V: Floats,
    label: Ints,
    area: Floats,
    parents: Ints,
    seen: Floats,
    chosen: FramePosesSettings,
    expected: Floats | None = None,
    takes: Sequence[slice] | None = None,
) -> PosePrior:
    """Each part's rotation from frames that saw it and its parent, held as firmly as its own surface would hold it."""
    turn = np.einsum("tpxy,tpxz->tpyz", motion.R[:, parents], motion.R)
    turn[:, 0] = motion.R[:, 0]
    both = np.minimum(seen, seen[:, np.maximum(parents, 0)])
    reach = np.bincount(label, area * ((V - motion.rest[label]) ** 2).sum(axis=1), len(parents))
    if expected is not None:
        wanted = np.where((both >= chosen.seen)[:, :, None, None], turn, expected)
        return PosePrior(wanted, chosen.hold * reach * (1.0 - both) ** 2)
    known = both >= chosen.seen
    wanted = np.concatenate(
        [
            np.stack([interpolated(turn[span, a], known[span, a]) for a in range(len(parents))], axis=1)
            for span in takes or [slice(0, len(turn))]
        ]
    )
    return PosePrior(wanted, chosen.hold * reach * (1.0 - both) ** 2)


def _by_part(value: Floats, label: Ints, area: Floats, parts: int) -> Floats:
    """(frame, part) sums of (frame, vertex) values by area."""
    return np.stack([np.bincount(label, area * row, parts) for row in value])


def _power(R: Floats, share: float) -> Floats:
    """The rotation by a share of the angle of R."""
    return np.asarray(Rotation.from_rotvec(share * Rotation.from_matrix(R).as_rotvec()).as_matrix())
