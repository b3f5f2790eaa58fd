"""A body that is followed without error, as the tasks of the shelf `structure` read it."""

import numpy as np

from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.topology.leaves import Leaves

FIRST = 10


def given(V: np.ndarray, F: np.ndarray, x: np.ndarray) -> tuple[Reference, dict[int, Alignment], Leaves]:
    """What the task reads."""
    frames = tuple(range(FIRST, FIRST + len(x)))
    reference = Reference(
        frames=frames, frame=FIRST + 2, vertices=V, faces=F, size=1.0, fixed=True, leaves=0, free=True,
        stems=np.zeros((0, 4, 3)), score=np.zeros(len(x)),
    )  # fmt: skip
    zero, one = np.zeros(len(V)), np.ones(len(V))
    aligned = {
        f: Alignment(vertices=y, residual=zero, stretch=one, confidence=one, uncovered=0.0)
        for f, y in zip(frames, x, strict=True)
    }
    leaves = Leaves(
        frames=frames, rows=np.zeros((0, len(x)), int), positions=np.zeros((0, len(x), 3)), kept=np.ones((1, 0), bool),
        lost=np.zeros(0, int), lost_begin=np.zeros(0, int), lost_end=np.zeros(0, int),
    )  # fmt: skip
    return reference, aligned, leaves
