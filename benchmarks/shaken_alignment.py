"""The alignment of a frame moved by a few smooth waves, for `stability.py`: a task of its own, in place of the real one."""

import numpy as np
import numpy.typing as npt

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index, Params
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.refit import Refit
from kinetree.tasks.registration.alignment import alignment as aligned

Floats = npt.NDArray[np.float64]
WAVES = 6
"""Of every frame. Not varied."""


class ShakenParams(Params):
    """How an alignment is shaken."""

    shake: int = 0
    """Number of the shake; 0 leaves the alignment as it is."""
    share: float = 0.0005
    """Amplitude, share of the height of the reference."""


@task(over="frame")
def alignment(
    mesh: Mesh,
    reference: Reference,
    deformation_graph: DeformationGraph,
    recovery: Recovery,
    refit: tuple[Refit, ...],
    params: ShakenParams,
    index: Index,
) -> Alignment:
    """The alignment of a frame, moved a little."""
    unshaken = aligned(mesh, reference, deformation_graph, recovery, refit)
    if params.shake == 0:
        return unshaken
    away = waves(np.array(reference.vertices), np.random.default_rng((params.shake, index[0])), params.share)
    return unshaken.model_copy(update={"vertices": unshaken.vertices + away})


def waves(V: Floats, rng: np.random.Generator, share: float) -> Floats:
    """(vertex, xyz) a smooth displacement whose root mean square along each axis is about `share` of the height of V."""
    height = float(np.ptp(V, axis=0).max())
    along, phase = rng.normal(size=(WAVES, 3)) * 6.0 / height, rng.uniform(0.0, 2.0 * np.pi, WAVES)
    amplitude = rng.normal(size=(WAVES, 3)) * share * height * np.sqrt(2.0 / WAVES)
    return np.asarray(np.sin(V @ along.T + phase) @ amplitude)
