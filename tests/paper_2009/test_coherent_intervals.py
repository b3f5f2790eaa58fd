"""Contract of coherent_intervals: all frames of a body that touches nothing, none of another topology."""

from volumetric import FRAMES, volumetric

from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervalsParams
from kinetree.tasks.paper_2009.coherent_intervals import coherent_intervals


def test_body_without_contact_is_coherent_throughout() -> None:
    runs = volumetric().coherent_intervals
    assert runs.coherent.all()
    assert (runs.begin.tolist(), runs.end.tolist()) == ([0], [FRAMES - 1])
    assert (runs.wanted_ends, runs.wanted_branches) == (3, ((3,),))


def test_body_with_other_ends_than_those_of_the_letter_is_incoherent() -> None:
    letter = CoherentIntervalsParams(ends=5, branches=((4, 3), (3, 3, 3)))
    assert not coherent_intervals(volumetric().perg, letter).coherent.any()
