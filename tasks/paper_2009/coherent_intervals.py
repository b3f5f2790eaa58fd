"""The runs of frames whose graphs have the body's topology."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.distance import pdist

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervals, CoherentIntervalsParams
from kinetree.schemas.paper_2009.perg import Perg
from kinetree.tasks.input.sequence import refuse_further
from kinetree.tasks.numerics.paper_2009 import coherent_intervals as numerics
from kinetree.tasks.numerics.paper_2009.graph_loops import branch_length


@task()
def coherent_intervals(pergs: Mapping[int, Perg], sequence: Sequence, params: CoherentIntervalsParams) -> CoherentIntervals:
    """Finds the frames without a loop that have the ends (i) and the branch points (ii) of the body (2009, Sec. 2.2)."""
    refuse_further(sequence, "the method of 2009")
    ends, loops = (np.array([len(a) for a in rows]) for rows in zip(*((p.end, p.reach) for p in pergs.values()), strict=True))
    degrees = tuple(p.degrees for p in pergs.values())
    runs = numerics.coherent_intervals(ends, loops, degrees, ends=params.ends, branches=params.branches, minimum=params.minimum)
    return CoherentIntervals(
        frames=tuple(pergs),
        coherent=runs.coherent,
        ends=ends,
        loops=loops,
        reach=np.array([p.reach.max(initial=0.0) for p in pergs.values()]),
        spread=np.array([_spread(p) for p in pergs.values()]),
        length=np.array([_length(p) for p in pergs.values()]),
        degrees=degrees,
        begin=runs.begin,
        end=runs.end,
        wanted_ends=runs.ends,
        wanted_branches=runs.branches,
    )


def _spread(graph: Perg) -> float:
    """Mean distance between the ends of a graph, share of the root of its body's area; 0 for fewer than two ends."""
    between = pdist(graph.node[graph.end])
    return float(between.mean() / np.sqrt(graph.area.sum())) if len(between) else 0.0


def _length(graph: Perg) -> float:
    """Geometric mean of the lengths of a graph's branches, share of the root of its body's area."""
    node, branch, end = np.array(graph.node), np.array(graph.branch, np.int64), np.array(graph.end, np.int64)
    return branch_length(node, np.array(graph.edge, np.int64), branch, end) / float(np.sqrt(graph.area.sum()))
