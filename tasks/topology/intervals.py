"""Where the sequence is cut, and by what."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.topology.correlation import Correlation
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.intervals import Intervals, IntervalsParams
from kinetree.tasks.numerics.topology import intervals as numerics


@task()
def intervals(correlation: Correlation, tips: Mapping[int, Extrema], params: IntervalsParams) -> Intervals:
    """Cuts the sequence at sharp drops of the correlation and where limbs join or part for good (2014, Sec. 4)."""
    cues = _cues(tuple(tips.values()), params.step)
    if params.rule == "fixed":
        found = numerics.fixed_intervals(correlation.correlation, params.threshold, params.minimum)
    else:
        found = numerics.intervals(
            correlation.histograms,
            {name: cue for name, cue in cues.items() if name in params.cues},
            high=params.high,
            low=params.low,
            drop=params.drop,
            minimum=params.minimum,
            correlation="correlation" in params.cues,
        )
    return Intervals(
        frames=tuple(tips),
        begin=found.begin,
        end=found.end,
        z=found.z,
        cues=found.cues,
        strengths=np.stack([found.z / max(params.high, 1e-9), *(_strength(cue) for cue in cues.values())]),
        cue_names=(numerics.CORRELATION, *cues),
        threshold=params.threshold if params.rule == "fixed" else params.high,
    )


def _strength(cue: numerics.Cue) -> NDArray[np.float64]:
    return numerics.sharpness(cue.profile) / cue.least


def _cues(tips: tuple[Extrema, ...], step: float) -> dict[str, numerics.Cue]:
    """What stays the same while nothing touches; the first peak reaches over the whole range and tells nothing."""
    return {
        "leaves": numerics.Cue(numerics.stacked([t.peaks[1:] for t in tips]), step),
        "loops": numerics.Cue(numerics.stacked([t.loops for t in tips]), step),
        "components": numerics.Cue(np.array([[float(t.components)] for t in tips]), 1.0),
        "euler": numerics.Cue(np.array([[float(t.euler)] for t in tips]), 1.0),
    }
