"""How far limbs that do not belong together stay from each other: balls along the limbs, compared pair by pair."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import shortest_path

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh


class ClearanceSettings(NamedTuple):
    """How limbs are compared: as balls along their axes."""

    balls: int = 8
    """Balls along a limb, evenly spread over its axis."""
    apart: float = 2.2
    """Multiple of the sum of two balls' radii; balls nearer along the tree are neighbours, not limbs that may meet."""


_SETTINGS = ClearanceSettings()


def clearance(figure: Figure, flesh: Flesh, X: Floats, ignored: Flags | None = None) -> Floats:
    """Smallest gap between limbs that are far apart along the tree; negative when they overlap.

    X       : (frame, joint, xyz)
    ignored : (limb, limb) pairs that are not compared, none when None
    returns : (frame,) in the figure's unit; infinite for a figure without two such limbs
    """
    s = np.linspace(0.0, 1.0, _SETTINGS.balls)
    r = flesh.table[:, np.linspace(0, flesh.table.shape[1] - 1, _SETTINGS.balls).astype(int)].ravel()
    far = _path_lengths(figure, flesh, s) > _SETTINGS.apart * (r[:, None] + r[None, :])
    if ignored is not None:
        far &= ~ignored.repeat(_SETTINGS.balls, axis=0).repeat(_SETTINGS.balls, axis=1)
    i, j = np.nonzero(np.triu(far, 1))
    gap = np.full(len(X), np.inf)
    if len(i):
        for t, x in enumerate(X):
            balls = (x[flesh.parent, None] + s[:, None] * (x[flesh.child] - x[flesh.parent])[:, None]).reshape(-1, 3)
            gap[t] = np.min(np.linalg.norm(balls[i] - balls[j], axis=1) - r[i] - r[j])
    return gap


def _path_lengths(figure: Figure, flesh: Flesh, s: Floats) -> Floats:
    """(ball, ball) lengths of the ways along the limbs' axes at rest."""
    limbs, joints = len(flesh.parent), len(figure.joints)
    ball = np.arange(limbs * _SETTINGS.balls).reshape(limbs, _SETTINGS.balls)
    length = np.linalg.norm(figure.rest[flesh.child] - figure.rest[flesh.parent], axis=1)
    # A zero would mean "no edge" to the sparse graph, so balls at a joint are tied to it by a negligible length.
    rows = [ball[:, :-1].ravel(), ball[:, 0], ball[:, -1]]
    columns = [ball[:, 1:].ravel(), limbs * _SETTINGS.balls + flesh.parent, limbs * _SETTINGS.balls + flesh.child]
    tie = 1e-9 * length
    weights = [np.repeat(length / (_SETTINGS.balls - 1), _SETTINGS.balls - 1), tie, tie]
    size = limbs * _SETTINGS.balls + joints
    graph = coo_matrix((np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), shape=(size, size))
    paths = shortest_path(graph.tocsr(), directed=False)
    return np.asarray(paths[: limbs * _SETTINGS.balls, : limbs * _SETTINGS.balls], dtype=np.float64)
