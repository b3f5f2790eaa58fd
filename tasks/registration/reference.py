"""The one mesh that follows the body."""

from collections.abc import Mapping

import numpy as np

from kinetree.errors import SourceError
from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.reference import Reference, ReferenceParams
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.mu_histogram import MuHistogram
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.registration import reference as numerics

QUANTILES = 100


@task(among=Sequence)
def reference(
    mesh: Mapping[int, Mesh],
    distribution: Mapping[int, MuHistogram],
    tips: Mapping[int, Extrema],
    leaves: Leaves,
    connectivity: Connectivity,
    params: ReferenceParams,
) -> Reference:
    """Chooses the frame to which all others are aligned, free of contact and amid the poses (2014, Sec. 5.3)."""
    frames = tuple(mesh)
    count = [len(t.vertices) for t in tips.values()]
    euler = [t.euler for t in tips.values()]
    area = [m.cleaning.area for m in mesh.values()]
    profile = np.stack([_quantiles(d) for d in distribution.values()])
    if params.frame is not None and params.frame not in frames:
        raise SourceError(
            f"reference.frame: frame {params.frame} is none of the {len(frames)} frames that the body is learned from,"
            f" which are {frames[0]} to {frames[-1]}; see sequence.learn_from"
        )
    pinned = None if params.frame is None else frames.index(params.frame)
    followed, takes = followed_stems(leaves, tuple(tips.values())), take_spans(frames)
    chosen = numerics.reference(count, euler, area, profile, followed, frame=pinned, takes=takes)
    mine = mesh[frames[chosen.frame]]
    return Reference(
        frames=frames,
        frame=frames[chosen.frame],
        fixed=connectivity.fixed,
        leaves=max(count),
        free=chosen.free,
        loop=float(tips[frames[chosen.frame]].loops.max(initial=0.0)),
        vertices=mine.vertices,
        faces=mine.faces,
        size=float(np.sqrt(area[chosen.frame])),
        stems=tips[frames[chosen.frame]].stems,
        score=chosen.score,
    )


def followed_stems(leaves: Leaves, tips: tuple[Extrema, ...]) -> Floats:
    """(leaf, frame, station, xyz) the stem of every leaf that was followed; NaN where it is not seen."""
    shape = tips[0].stems.shape[1:]
    stems = np.full((*leaves.rows.shape, *shape), np.nan)
    for t, own in enumerate(tips):
        here = np.flatnonzero(leaves.rows[:, t] >= 0)
        stems[here, t] = own.stems[leaves.rows[here, t]]
    return stems


def _quantiles(distribution: MuHistogram) -> Floats:
    """(quantile,) of μ over the surface, which change with the pose, from its fine histogram."""
    edges = np.linspace(distribution.low, distribution.high, len(distribution.mass) + 1)
    total = np.concatenate([[0.0], np.cumsum(distribution.mass)])
    quantiles: Floats = np.interp((np.arange(QUANTILES) + 0.5) / QUANTILES * total[-1], total, edges)
    return quantiles
