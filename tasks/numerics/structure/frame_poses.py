"""A pose for every frame, also where a limb touches or is lost, and how far each is to be believed (2014, Sec. 7.3).

What was seen and trusted is fitted. Where little of a part was, its turning against its parent is held to what it was
in the frames around in which it was seen, on the shortest way from the one to the other.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import Expected, Motion, fitted, predicted, sums

SEEN = 0.5
"""Share of a part's surface that must be trusted for its pose to serve other frames."""
HOLD = 0.3
"""Weight of the frames around against a part seen in full, where nothing of it is seen."""
ENOUGH = 250
"""Vertices of a part that a fit asks."""
MARGIN = 0.02
"""Error of a part, share of the root of the area, at which its pose is worth half."""


class Posed(NamedTuple):
    """Every frame's pose.

    motion     : rotations of all parts and places of the root
    error      : (frame, part) root mean square distance of a part's vertices to the model where they are trusted, mesh unit
    confidence : (frame, part) 0 to 1: how much of the part and of its parent was seen, and how well they fit
    """

    motion: Motion
    error: Floats
    confidence: Floats


def posed(
    V: Floats, x: Floats, area: Floats, label: Ints, W: Floats, start: Motion, parents: Ints, trust: Floats | None = None
) -> Posed:
    """Fits the finished body to every frame.

    V, x  : (vertex, xyz) mesh unit, (frame, vertex, xyz)
    area  : (vertex,) mesh unit²
    label : (vertex,) part, W : (vertex, part) skinning weights
    start : joints, and poses to start from
    trust : (frame, vertex) 0 to 1; None believes all
    """
    share = area / area.sum()
    seen = seen_share(label, share, trust, len(x), len(parents))
    asked, mass = some(label, share, len(parents))
    if trust is None:
        motion = fitted(sums(V[asked], x[:, asked], W[asked], parents, mass), start, parents)
    else:
        s = sums(V[asked], x[:, asked], W[asked], parents, mass * np.maximum(trust[:, asked], 1e-6))
        free = fitted(s, start, parents, _expected(start, V, label, share, parents, seen))
        motion = fitted(s, free, parents, _expected(free, V, label, share, parents, seen))
    believed = np.ones(x.shape[:2]) if trust is None else trust
    square = believed * ((predicted(V, W, motion, parents) - x) ** 2).sum(axis=2)
    error = np.sqrt(
        _by_part(square, label, share, len(parents)) / np.maximum(_by_part(believed, label, share, len(parents)), 1e-12)
    )
    fit = seen / (1.0 + (error / (MARGIN * np.sqrt(area.sum()))) ** 2)
    above = np.maximum(parents, 0)
    return Posed(motion, error, np.clip(np.minimum(fit, fit[:, above]), 0.0, 1.0))


def some(label: Ints, area: Floats, parts: int) -> tuple[Ints, Floats]:
    """Vertices that a fit asks, evenly many of every part, and what each stands for: together their part's whole area.

    label, area : (vertex,)
    returns     : (asked,) vertices, ascending · (asked,) area
    """
    order = np.argsort(label, kind="stable")
    count = np.bincount(label, minlength=parts)
    rank = np.arange(len(label)) - np.repeat(np.cumsum(count) - count, count)
    every = -(-count // ENOUGH)
    asked = np.sort(order[rank % np.repeat(np.maximum(every, 1), count) == 0])
    whole, held = (np.bincount(label[v], area[v], parts) for v in (np.arange(len(label)), asked))
    return asked, area[asked] * (whole / np.maximum(held, 1e-300))[label[asked]]


def seen_share(label: Ints, area: Floats, trust: Floats | None, frames: int, parts: int) -> Floats:
    """(frame, part) share of each part's surface that is trusted."""
    if trust is None:
        return np.ones((frames, parts))
    return np.clip(_by_part(trust, label, area, parts) / np.maximum(np.bincount(label, area, parts), 1e-300), 0.0, 1.0)


def between(turn: Floats, known: Flags) -> Floats:
    """Rotations (frame, 3, 3), where not known on the shortest way between the nearest known; at the ends the nearest.

    Where none is known all stay as they are.
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


def _expected(motion: Motion, V: Floats, label: Ints, area: Floats, parents: Ints, seen: Floats) -> Expected:
    """Each part's turning from frames that saw it and its parent; held by what its own surface would hold it by."""
    turn = np.einsum("tpxy,tpxz->tpyz", motion.R[:, parents], motion.R)
    turn[:, 0] = motion.R[:, 0]
    both = np.minimum(seen, seen[:, np.maximum(parents, 0)])
    reach = np.bincount(label, area * ((V - motion.rest[label]) ** 2).sum(axis=1), len(parents))
    wanted = np.stack([between(turn[:, a], both[:, a] >= SEEN) for a in range(len(parents))], axis=1)
    return Expected(wanted, HOLD * reach * (1.0 - both) ** 2)


def _by_part(value: Floats, label: Ints, area: Floats, parts: int) -> Floats:
    """(frame, part) sums of (frame, vertex) values by area."""
    return np.stack([np.bincount(label, area * row, parts) for row in value])


def _power(R: Floats, share: float) -> Floats:
    """The rotation by a share of the angle of R."""
    return np.asarray(Rotation.from_rotvec(share * Rotation.from_matrix(R).as_rotvec()).as_matrix())
