"""Contract of integrated_structure: the most detailed branches on one model that reaches all frames."""

import numpy as np
import pytest
from volumetric import FRAMES, volumetric


@pytest.mark.parametrize("letter", [False, True])
def test_every_frame_is_reached_from_the_initial_one(letter: bool) -> None:
    one = volumetric(letter=letter).integrated_structure
    for frame in one.frames:
        here, steps = frame, 0
        while one.previous(here) is not None:
            here, steps = int(one.previous(here) or 0), steps + 1
            assert steps < FRAMES
        assert here == one.frame


def test_single_structure_is_taken_as_it_is() -> None:
    here = volumetric()
    assert np.array_equal(here.integrated_structure.cluster, here.node_clusters[0].cluster)
    assert (here.integrated_structure.source == 0).all()
