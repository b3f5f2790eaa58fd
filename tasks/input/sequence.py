"""The sequence as a whole: which frames, how fast, in what unit, and which frames decide about the others."""

from collections.abc import Mapping

from kinetree.errors import SourceError
from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence, SequenceParams
from kinetree.schemas.input.source import Source
from kinetree.tasks.numerics.input.frame_numbers import selected_frames


@task()
def sequence(source: Mapping[int, Source], params: SequenceParams) -> Sequence:
    """Gathers frame numbers, rate and unit; what the user says goes before what the files state (2014, Sec. 3)."""
    rates = sorted({s.fps for s in source.values() if s.fps is not None})
    units = sorted({s.unit for s in source.values() if s.unit is not None})
    if params.fps is None and len(rates) > 1:
        raise SourceError(f"the files state different frame rates ({rates}); say which with sequence.fps")
    if params.unit is None and len(units) > 1:
        raise SourceError(f"the files state different units ({units}); say which with sequence.unit")
    learned = selected_frames(params.learn_from, list(source), "the sequence")
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
        further=tuple(t for t in source if t not in set(learned)),
    )


def refuse_further(sequence: Sequence, method: str) -> None:
    """Refuses frames that nothing is learned from, for a method that poses no others; raises SourceError."""
    if sequence.further:
        raise SourceError(
            f"sequence.learn_from leaves out {len(sequence.further)} of {len(sequence.frames)} frames, for which {method} finds"
            " no poses; learn from all frames, or use the default method"
        )
