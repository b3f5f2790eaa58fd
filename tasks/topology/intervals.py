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
from kinetree.tasks.numerics.topology import intervals as numerics


@task(among=Sequence)
def intervals(
    correlation: Correlation, extrema: Mapping[int, Extrema], connectivity: Connectivity, params: IntervalsParams
) -> Intervals:
    """Cuts the sequence at sharp drops of the correlation and where limbs join or part for good (2014, Sec. 4)."""
    if params.tracked == "whole" and connectivity.fixed:
        return _whole(tuple(extrema))
    cues = _cues(tuple(extrema.values()), params.step)
    if params.rule == "fixed":
        cut = numerics.fixed_intervals(correlation.correlation, params.threshold, params.minimum)
    else:
        cut = numerics.intervals(
            correlation.histograms,
            {name: cue for name, cue in cues.items() if name in params.cues},
            high=params.high,
            low=params.low,
            drop=params.drop,
            minimum=params.minimum,
            correlation="correlation" in params.cues,
        )
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


def _whole(frames: tuple[int, ...]) -> Intervals:
    """All frames as one interval: correspondence comes with the input (Sec. 7)."""
    none = np.zeros(len(frames) - 1)
    return Intervals(
        frames=frames, begin=np.zeros(1, int), end=np.array([len(frames) - 1]), z=none, cues=(), strengths=none[None],
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
