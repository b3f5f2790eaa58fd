"""The input mesh of one frame as the player of the report shows it."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.coarse_mesh import CoarseMesh
from kinetree.schemas.results.excerpt import Excerpt
from kinetree.tasks.results.page.coarse import coarse


@task(over="frame", along=Excerpt)
def coarse_mesh(mesh: Mesh, projection: Projection, excerpt: Excerpt, previous: CoarseMesh | None, index: Index) -> CoarseMesh:
    """Decimates the frame's mesh, or takes the same vertices as in an earlier frame with the same faces (ours)."""
    if index[0] not in excerpt.frames:
        none = np.zeros(0, np.int32)
        return CoarseMesh(
            size=0, extent=(), vertices=np.zeros((0, 3)), reference_face=none, reference_corner=none, kept=none,
            faces=np.zeros((0, 3), np.int32),
        )  # fmt: skip
    return coarse(mesh, projection, previous, excerpt.input_vertices)
