"""The sequence as a whole: which frames, how fast, in what unit, and which frames decide about the others."""

from collections.abc import Mapping

from kinetree.errors import SourceError
from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence, SequenceParams
from kinetree.schemas.input.source import Source
from kinetree.tasks.numerics.input.frame_numbers import TAKE, selected_frames, take_spans


@task()
def sequence(source: Mapping[int, Source], params: SequenceParams) -> Sequence:
    """Gathers frame numbers, rate and unit; what the user says goes before what the files state (2014, Sec. 3)."""
    rates = sorted({s.fps for s in source.values() if s.fps is not None})
    units = sorted({s.unit for s in source.values() if s.unit is not None})
    if params.fps is None and len(rates) > 1:
        raise SourceError(f"the files state different frame rates ({rates}); say which with sequence.fps")
    if params.unit is None and len(units) > 1:
        raise SourceError(f"the files state different units ({units}); say which with sequence.unit")
    numbers = list(source)
    takes = tuple(dict.fromkeys(s.take for s in source.values() if s.take))
    learned = [t for span in take_spans(numbers) for t in _learned(numbers[span], params.learn_from)]
    if len(learned) < 2 <= len(source):
        raise SourceError(
            f"sequence.learn_from: {params.learn_from!r} selects frame {learned[0]} alone; a body is learned from its motion,"
            " select at least two frames"
        )
    return Sequence(
        frames=tuple(source),
        fps=params.fps if params.fps is not None else next(iter(rates), None),
        unit=params.unit if params.unit is not None else next(iter(units), None),
        dropped=tuple(sorted((bad for s in source.values() for bad in s.dropped), key=lambda bad: bad.frame)),
        takes=takes,
        further=tuple(t for t in source if t not in set(learned)),
    )


def _learned(numbers: list[int], learn_from: str) -> list[int]:
    """The frames of one take from which the body is learned."""
    first = numbers[0] // TAKE * TAKE
    return [first + t for t in selected_frames(learn_from, [number - first for number in numbers], "the sequence")]


def refuse_further(sequence: Sequence, method: str) -> None:
    """Refuses frames that nothing is learned from, and several takes, for a method that has no poses for them."""
    if sequence.takes:
        raise SourceError(f"source.takes: {method} takes one take alone; use the default method")
    if sequence.further:
        raise SourceError(
            f"sequence.learn_from leaves out {len(sequence.further)} of {len(sequence.frames)} frames, for which {method} finds"
            " no poses; learn from all frames, or use the default method"
        )
