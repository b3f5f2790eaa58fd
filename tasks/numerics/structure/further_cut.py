"""The body cut once more, in another of its poses: what a joint's place owes to the chance of one cut (ours).

Where patches and rings fall moves joints. In another pose they fall elsewhere, so that joints which several cuts place alike
are known well, and their mean is nearer to the truth than any of them.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints

CERTAIN = 0.3
"""Share of the frames, those aligned least certainly, that no further cut is made in. Not recorded."""
LANDMARKS = 300
"""Vertices that poses are compared by, at most; for time."""


def distinct_poses(x: Floats, confidence: Floats | None, reference: int, count: int) -> Ints:
    """Frames whose poses differ most from the reference's and from one another's: farthest-point sampling of poses (ours).

    x          : (frame, vertex, xyz) mesh unit
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    reference  : position of the reference among the frames
    count      : frames wanted; fewer where there are not so many other poses
    returns    : positions of frames, in the order of choice
    """
    every = max(x.shape[1] // LANDMARKS, 1)
    X = x[:, ::every] - x.mean(axis=1, keepdims=True)
    X = X.reshape(len(x), -1)
    certain = np.ones(len(x)) if confidence is None else confidence.mean(axis=1)
    may = certain >= np.quantile(certain, CERTAIN)
    away = np.linalg.norm(X - X[reference], axis=1)
    chosen: list[int] = []
    while len(chosen) < count:
        score = np.where(may, away, 0.0)
        farthest = int(score.argmax())
        if not score[farthest] > 0.0:
            break
        chosen.append(farthest)
        away = np.minimum(away, np.linalg.norm(X - X[farthest], axis=1))
    return np.array(chosen, np.int64)
