"""How far the skinned mesh and the input mesh are from each other in one frame."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.results.surface_error import SurfaceError
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results import surface_error as numerics
from kinetree.tasks.results.formats.rig import skinned


@task(over="frame")
def surface_error(skeleton: Skeleton, mesh: Mesh, index: Index) -> SurfaceError:
    """Measures the skinned mesh and the joints against the input mesh (ours)."""
    t = skeleton.frames.index(index[0])
    error = numerics.surface_error(
        skinned(skeleton, t),
        np.array(skeleton.faces),
        np.array(skeleton.label),
        np.array(skeleton.positions[t]),
        np.array(mesh.vertices),
        np.array(mesh.faces),
    )
    return SurfaceError(**{**error._asdict(), "distance": error.distance.astype(np.float32)})
