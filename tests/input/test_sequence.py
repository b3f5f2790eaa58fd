"""Contracts of the sequence: frames in order, what the user says before what files state, disagreement refused."""

from typing import get_args

import pytest

from kinetree.errors import SourceError
from kinetree.pipeline.views import remarks
from kinetree.schemas.input.sequence import Sequence, SequenceParams, Unit
from kinetree.schemas.input.source import BadFrame, Source
from kinetree.tasks.input.sequence import sequence
from kinetree.tasks.numerics.input.frame_numbers import TAKE
from kinetree.tasks.numerics.results.units import METRES


def frames(*fields, start=0):
    return {t: Source(content=f"{t}", path="x", fps=fps, unit=unit) for t, (fps, unit) in enumerate(fields, start)}


def test_numbers_of_the_frames_are_kept():
    sources = {t: s for t, s in frames(*[(None, None)] * 6).items() if t % 2}
    assert sequence(sources, SequenceParams()) == Sequence(frames=(1, 3, 5), fps=None, unit=None)


def test_what_the_files_state_is_believed():
    result = sequence(frames((25.0, "mm"), (25.0, None), (None, "mm")), SequenceParams())
    assert (result.fps, result.unit) == (25.0, "mm")


def test_user_goes_before_the_files():
    result = sequence(frames((25.0, "mm"), (30.0, "cm")), SequenceParams(fps=50, unit="m"))
    assert (result.fps, result.unit) == (50.0, "m")


def test_files_that_disagree_are_refused_with_the_key_that_settles_it():
    with pytest.raises(SourceError, match=r"different frame rates \(\[25\.0, 30\.0\]\); say which with sequence\.fps"):
        sequence(frames((30.0, None), (25.0, None)), SequenceParams())
    with pytest.raises(SourceError, match=r"different units \(\['cm', 'mm'\]\); say which with sequence\.unit"):
        sequence(frames((None, "mm"), (None, "cm")), SequenceParams(fps=25))


@pytest.mark.parametrize(
    ("said", "unit"),
    [("MM", "mm"), ("feet", "ft"), ("foot", "ft"), ("inches", "in"), ("Inch", "in"), ("metres", "m"), ("meter", "m"),
     ("M", "m"), ("millimetres", "mm"), ("centimeter", "cm"), ("km", "km"), (None, None)],
)  # fmt: skip
def test_unit_is_known_by_its_plain_names_in_any_case(said, unit):
    assert SequenceParams(unit=said).unit == unit


@pytest.mark.parametrize("unit", ["furlong", "", "µm", "mmm", 5])
def test_unit_that_is_not_known_is_refused_with_those_that_are(unit):
    with pytest.raises(ValueError, match="'mm', 'cm', 'dm', 'm', 'km', 'in' or 'ft'"):
        SequenceParams(unit=unit)


def test_every_unit_that_is_known_has_a_length():
    assert get_args(get_args(Unit)[0]) == tuple(METRES)


@pytest.mark.parametrize("fps", [0, -25, float("inf"), float("nan")])
def test_rate_that_is_none_is_refused(fps):
    with pytest.raises(ValueError, match="fps"):
        SequenceParams(fps=fps)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((0, 1, 2), ()),
        ((0, 2, 4), ()),
        ((5,), ()),
        ((0, 1, 3), ("1 frame is missing: 2; the frames before and after a gap are taken as neighbours",)),
        ((1, 3, 9, 11, 15), ("3 frames are missing: 5 to 7, 13; the frames before and after a gap are taken as neighbours",)),
    ],
)
def test_frames_that_the_numbering_leaves_out_are_named(numbers, words):
    assert remarks(Sequence(frames=numbers, fps=None, unit=None)) == words


def test_many_gaps_are_counted():
    (words,) = remarks(Sequence(frames=tuple(range(0, 90, 3)) + (88, 89), fps=None, unit=None))
    assert words.startswith("58 frames are missing: 1 to 2, 4 to 5,")
    assert "22 to 23 and 21 more gaps;" in words


def test_frames_that_were_left_out_are_named_with_the_reason_and_are_no_gap():
    sources = frames((None, None), (None, None), (None, None))
    sources[3] = sources[2].model_copy(update={"dropped": (BadFrame(frame=4, reason="torn"),)})
    sources[0] = sources[0].model_copy(update={"dropped": (BadFrame(frame=2, reason="empty"),)})
    del sources[2]
    result = sequence(sources, SequenceParams())
    assert (result.frames, [bad.frame for bad in result.dropped]) == ((0, 1, 3), [2, 4])
    assert remarks(result) == ("2 of 5 frames were left out of everything: frame 2: empty; frame 4: torn",)


def test_a_selection_says_which_frames_the_body_is_learned_from():
    result = sequence(frames(*[(None, None)] * 6, start=3), SequenceParams(learn_from=":7"))
    assert (result.frames, result.learned, result.further) == ((3, 4, 5, 6, 7, 8), (3, 4, 5, 6), (7, 8))
    assert (result.selected(), result.members("further", ()), result.members("further/frame", (8,))) == (
        (3, 4, 5, 6),
        (7, 8),
        (8,),
    )
    all_of_them = sequence(frames(*[(None, None)] * 6), SequenceParams())
    assert (all_of_them.learned, all_of_them.members("further", ())) == (all_of_them.frames, ())


def test_a_selection_of_one_frame_or_none_is_refused():
    with pytest.raises(
        SourceError, match=r"sequence\.learn_from: '0:1' selects frame 0 alone; a body is learned from its motion"
    ):
        sequence(frames(*[(None, None)] * 6), SequenceParams(learn_from="0:1"))
    with pytest.raises(SourceError, match="'9:12' selects none of the 6 frames of the sequence"):
        sequence(frames(*[(None, None)] * 6), SequenceParams(learn_from="9:12"))


def test_further_frames_are_told():
    fields = {"frames": tuple(range(8)), "fps": None, "unit": None}
    assert remarks(Sequence(**fields, further=(6, 7))) == (
        "the body is learned from 6 frames (0 to 5); 2 other frames (6 to 7) are posed by it",
    )
    assert remarks(Sequence(**fields, further=(7,))) == ("the body is learned from 7 frames (0 to 6); frame 7 is posed by it",)


def test_takes_are_named_and_each_is_learned_from_by_its_own_numbers():
    sources = {k * TAKE + t: Source(content=f"{k}{t}", path="x", take=take) for k, take in enumerate("ab") for t in range(4)}
    result = sequence(sources, SequenceParams(learn_from=":3"))
    assert result.takes == ("a", "b")
    assert result.further == (3, TAKE + 3)
    assert remarks(result.model_copy(update={"further": ()})) == ()
