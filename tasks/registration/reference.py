"""The one mesh that follows the body, and the order in which frames are reached from it."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.mu_histogram import MuHistogram
from kinetree.tasks.numerics.registration import reference as numerics

QUANTILES = 100


@task()
def reference(
    mesh: Mapping[int, Mesh],
    distribution: Mapping[int, MuHistogram],
    tips: Mapping[int, Extrema],
    leaves: Leaves,
    connectivity: Connectivity,
) -> Reference:
    """Chooses the frame to which all others are aligned, free of contact and amid the poses (2014, Sec. 5.3)."""
    frames = tuple(mesh)
    count = [len(t.vertices) for t in tips.values()]
    euler = [t.euler for t in tips.values()]
    area = [m.cleaning.area for m in mesh.values()]
    profile = np.stack([_quantiles(d) for d in distribution.values()])
    chosen = numerics.reference(count, euler, area, profile, _followed(leaves, tuple(tips.values())))
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
        score=chosen.score,
        before=np.full(len(frames), -1) if connectivity.fixed else outwards(len(frames), chosen.frame),
    )


def outwards(count: int, start: int) -> NDArray[np.int64]:
    """(frame,) the position from which each frame is reached, from `start` to both ends; −1 for `start`."""
    at = np.arange(count)
    before: NDArray[np.int64] = np.where(at == start, -1, at - np.sign(at - start))
    return before


def _followed(leaves: Leaves, tips: tuple[Extrema, ...]) -> Floats:
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
