"""The way from one frame's own input vertices to the reference mesh."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.registration.reference import Reference
from kinetree.tasks.numerics.geometry.closest_point import projected


@task(over="frame")
def projection(mesh: Mesh, reference: Reference, alignment: Alignment) -> Projection:
    """Finds for every vertex of the user's file the nearest point of the aligned reference mesh (ours)."""
    nearest = projected(np.array(mesh.vertices), np.array(alignment.vertices), reference.faces)
    became = mesh.vertex_of_input.astype(np.int64)
    survives = became >= 0
    return Projection(
        face=np.where(survives, nearest.face[became], -1),
        share=np.where(survives[:, None], nearest.share[became], 0.0),
        distance=np.where(survives, nearest.distance[became], np.nan),
    )
