"""The runs of frames whose graphs have the body's topology."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervals, CoherentIntervalsParams
from kinetree.schemas.paper_2009.perg import Perg
from kinetree.tasks.numerics.paper_2009 import coherent_intervals as numerics


@task()
def coherent_intervals(pergs: Mapping[int, Perg], params: CoherentIntervalsParams) -> CoherentIntervals:
    """Finds the frames without a loop that have the ends (i) and the branch points (ii) of the body (2009, Sec. 2.2)."""
    ends, loops = (np.array([len(a) for a in rows]) for rows in zip(*((p.end, p.reach) for p in pergs.values()), strict=True))
    degrees = tuple(p.degrees for p in pergs.values())
    runs = numerics.coherent_intervals(ends, loops, degrees, ends=params.ends, branches=params.branches, minimum=params.minimum)
    return CoherentIntervals(
        frames=tuple(pergs),
        coherent=runs.coherent,
        ends=ends,
        loops=loops,
        reach=np.array([p.reach.max(initial=0.0) for p in pergs.values()]),
        length=np.array([_length(p) for p in pergs.values()]),
        degrees=degrees,
        begin=runs.begin,
        end=runs.end,
        wanted_ends=runs.ends,
        wanted_branches=runs.branches,
    )


def _length(graph: Perg) -> float:
    """Length of a graph's edges, share of the root of its body's area."""
    ends = graph.node[graph.edge]
    return float(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum() / np.sqrt(graph.area.sum()))
