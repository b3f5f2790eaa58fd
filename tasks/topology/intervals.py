"""Where the sequence is cut, and by what."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.topology.correlation import Correlation
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.intervals import Intervals, IntervalsParams
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.topology import intervals as numerics


@task(among=Sequence)
def intervals(
    correlation: Correlation, extrema: Mapping[int, Extrema], connectivity: Connectivity, params: IntervalsParams
) -> Intervals:
    """Cuts the sequence at sharp drops of the correlation and where limbs join or part for good (2014, Sec. 4)."""
    spans = take_spans(tuple(extrema))
    if params.tracked == "whole" and connectivity.fixed:
        return _whole(tuple(extrema), spans)
    cues = _cues(tuple(extrema.values()), params.step)
    cut = numerics.joined([_cut(correlation, cues, span, params) for span in spans])
    return Intervals(
        frames=tuple(extrema),
        begin=cut.begin,
        end=cut.end,
        z=cut.z,
        cues=cut.cues,
        strengths=np.stack([cut.z / max(params.high, 1e-9), *(_strength(cue) for cue in cues.values())]),
        cue_names=(numerics.CORRELATION, *cues),
        threshold=params.threshold if params.rule == "fixed" else params.high,
    )


def _cut(correlation: Correlation, cues: dict[str, numerics.Cue], span: slice, params: IntervalsParams) -> numerics.Intervals:
    """The intervals of one take, by its own frames alone."""
    if params.rule == "fixed":
        inside = slice(span.start, span.stop - 1)
        return numerics.fixed_intervals(correlation.correlation[inside], params.threshold, params.minimum)
    return numerics.intervals(
        correlation.histograms[span],
        {name: cue._replace(profile=cue.profile[span]) for name, cue in cues.items() if name in params.cues},
        high=params.high,
        low=params.low,
        drop=params.drop,
        minimum=params.minimum,
        correlation="correlation" in params.cues,
    )


def _whole(frames: tuple[int, ...], spans: list[slice]) -> Intervals:
    """All frames of a take as one interval: correspondence comes with the input (Sec. 7)."""
    none = np.zeros(len(frames) - 1)
    begin, end = np.array([span.start for span in spans]), np.array([span.stop - 1 for span in spans])
    return Intervals(
        frames=frames, begin=begin, end=end, z=none, cues=((numerics.TAKE,),) * (len(spans) - 1), strengths=none[None],
        cue_names=(numerics.CORRELATION,), threshold=0.0,
    )  # fmt: skip


def _strength(cue: numerics.Cue) -> Floats:
    """How near a cue comes to cutting at each transition, 1 being enough."""
    return numerics.sharpness(cue.profile) / cue.least


def _cues(extrema: tuple[Extrema, ...], step: float) -> dict[str, numerics.Cue]:
    """What stays the same while nothing touches. The first peak spans the whole range on every frame and is left out."""
    return {
        "leaves": numerics.Cue(numerics.stacked([t.peaks[1:] for t in extrema]), step),
        "loops": numerics.Cue(numerics.stacked([t.loops for t in extrema]), step),
        "components": numerics.Cue(np.array([[float(t.components)] for t in extrema]), 1.0),
        "euler": numerics.Cue(np.array([[float(t.euler)] for t in extrema]), 1.0),
    }
