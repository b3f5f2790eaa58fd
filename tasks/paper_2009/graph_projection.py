"""Every frame's input vertices on the mesh of the integrated structure, as the projection that every method ends with."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.tasks.numerics.geometry.closest_point import projected


@task(over="frame")
def graph_projection(mesh: Mesh, integrated_structure: IntegratedStructure, alignment: Alignment) -> Projection:
    """Finds for every vertex of the user's file the nearest point of the structure's mesh (ours, for 2009, Sec. 2.5)."""
    nearest = projected(np.array(mesh.vertices), np.array(alignment.vertices), np.array(integrated_structure.faces))
    became = mesh.vertex_of_input.astype(np.int64)
    is_body = became >= 0
    return Projection(
        face=np.where(is_body, nearest.face[became], -1),
        share=np.where(is_body[:, None], nearest.share[became], 0.0),
        distance=np.where(is_body, nearest.distance[became], np.nan),
    )
