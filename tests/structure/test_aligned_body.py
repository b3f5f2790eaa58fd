"""Which vertices of the reference the structure takes for ends of limbs."""

import numpy as np

from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.structure.arguments.aligned_body import tips_of

FRAMES = (10, 11, 12)


def test_a_leaf_that_the_references_frame_shows_is_an_end_though_it_counts_in_no_interval() -> None:
    V = np.eye(3)
    reference = Reference(
        frames=FRAMES, frame=11, vertices=V, faces=np.array([[0, 1, 2]]), size=1.0, fixed=False, leaves=2, free=True,
        stems=np.zeros((0, 4, 3)), score=np.zeros(3),
    )  # fmt: skip
    rows = np.array([[0, 0, 0], [1, -1, -1], [-1, 1, -1]])
    positions = np.where(rows[..., None] >= 0, V[:, None], np.nan)
    none = np.zeros(0, np.int64)
    kept = np.array([[True, False, False]])
    leaves = Leaves(frames=FRAMES, rows=rows, positions=positions, kept=kept, lost=none, lost_begin=none, lost_end=none)
    assert tips_of(reference, leaves).tolist() == [0, 2]
