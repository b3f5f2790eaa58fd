"""Contract of coherent_intervals: all frames of a body that touches nothing, none of another topology."""

import pytest
from volumetric import FRAMES, volumetric

from kinetree.errors import SourceError
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervalsParams
from kinetree.tasks.paper_2009.coherent_intervals import coherent_intervals


def test_body_without_contact_is_coherent_throughout() -> None:
    runs = volumetric().coherent_intervals
    assert runs.coherent.all()
    assert (runs.begin.tolist(), runs.end.tolist()) == ([0], [FRAMES - 1])
    assert (runs.wanted_ends, runs.wanted_branches) == (3, ((3,),))


def test_body_with_other_ends_than_those_of_the_letter_is_incoherent() -> None:
    letter = CoherentIntervalsParams(ends=5, branches=((4, 3), (3, 3, 3)))
    here = volumetric()
    all_frames = Sequence(frames=tuple(here.perg), fps=None, unit=None)
    assert not coherent_intervals(here.perg, all_frames, letter).coherent.any()


def test_frames_that_nothing_is_learned_from_are_refused():
    here = volumetric()
    growing = Sequence(frames=tuple(here.perg), fps=None, unit=None, further=(FRAMES - 1,))
    with pytest.raises(
        SourceError, match=rf"learn_from leaves out 1 of {FRAMES} frames, for which the method of 2009 finds no"
    ):
        coherent_intervals(here.perg, growing, CoherentIntervalsParams())
