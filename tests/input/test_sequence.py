"""Contracts of the sequence: frames in order, what the user says before what files state, disagreement refused."""

import pytest

from kinetree.errors import SourceError
from kinetree.schemas.input.sequence import Sequence, SequenceParams
from kinetree.schemas.input.source import Source
from kinetree.tasks.input.sequence import sequence


def frames(*told, start=0):
    return {t: Source(content=f"{t}", path="x", fps=fps, unit=unit) for t, (fps, unit) in enumerate(told, start)}


def test_numbers_of_the_frames_are_kept():
    given = {t: s for t, s in frames(*[(None, None)] * 6).items() if t % 2}
    assert sequence(given, SequenceParams()) == Sequence(frames=(1, 3, 5), fps=None, unit=None)


def test_what_the_files_state_is_believed():
    made = sequence(frames((25.0, "mm"), (25.0, None), (None, "mm")), SequenceParams())
    assert (made.fps, made.unit) == (25.0, "mm")


def test_user_goes_before_the_files():
    made = sequence(frames((25.0, "mm"), (30.0, "cm")), SequenceParams(fps=50, unit="m"))
    assert (made.fps, made.unit) == (50.0, "m")


def test_files_that_disagree_are_refused_with_the_key_that_settles_it():
    with pytest.raises(SourceError, match=r"different frame rates \(\[25\.0, 30\.0\]\); say which with sequence\.fps"):
        sequence(frames((30.0, None), (25.0, None)), SequenceParams())
    with pytest.raises(SourceError, match=r"different units \(\['cm', 'mm'\]\); say which with sequence\.unit"):
        sequence(frames((None, "mm"), (None, "cm")), SequenceParams(fps=25))


@pytest.mark.parametrize("fps", [0, -25, float("inf"), float("nan")])
def test_rate_that_is_none_is_refused(fps):
    with pytest.raises(ValueError, match="fps"):
        SequenceParams(fps=fps)
