"""Contract of initial_frames: one model of the sequence, or one for each coherent interval."""

import numpy as np
import pytest
from volumetric import FRAMES, INTERVALS, volumetric

from kinetree.errors import InputError
from kinetree.schemas.paper_2009.initial_frames import InitialFramesParams
from kinetree.tasks.paper_2009.initial_frames import initial_frames


def test_default_has_one_structure_of_all_frames() -> None:
    start = volumetric().initial_frames
    assert list(start.members("structure", ())) == [0]
    assert start.members("structure/frame", (0,)) == list(range(FRAMES))


def test_letter_has_one_structure_for_each_coherent_interval() -> None:
    start = volumetric(letter=True).initial_frames
    assert list(start.members("structure", ())) == list(range(INTERVALS))
    assert [len(start.members("structure/frame", (s,))) for s in range(INTERVALS)] == [5, 4]


@pytest.mark.parametrize("letter", [False, True])
def test_every_frame_is_reached_from_its_initial_frame(letter: bool) -> None:
    start = volumetric(letter=letter).initial_frames
    for frame, own in zip(start.frames, start.structure, strict=True):
        steps, here = 0, frame
        while own >= 0 and start.previous(here) is not None:
            here, steps = int(start.previous(here) or 0), steps + 1
            assert steps < FRAMES
        assert own < 0 or here == start.frames[start.initial[own]]


def test_sequence_without_a_coherent_interval_fails_in_the_letter_and_not_in_the_default() -> None:
    here = volumetric()
    none = np.zeros(0, np.int64)
    runs = here.coherent_intervals.model_copy(update={"coherent": np.zeros(FRAMES, bool), "begin": none, "end": none})
    assert not initial_frames(runs, here.similarity, InitialFramesParams()).coherent
    with pytest.raises(InputError, match="no topologically coherent interval: of 10 frames 10 have no loop"):
        initial_frames(runs, here.similarity, InitialFramesParams(scope="interval"))
