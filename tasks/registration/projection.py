"""The way from one frame's own input vertices to the reference mesh."""

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.registration.reference import Reference
from kinetree.tasks.numerics.geometry import closest_point as numerics

Ints = NDArray[np.int64]


@task(over="frame")
def projection(mesh: Mesh, reference: Reference, alignment: Alignment) -> Projection:
    """Finds for every vertex of the user's file the nearest point of the aligned reference mesh (ours)."""
    faces = reference.faces.astype(np.int64)
    if alignment.given:
        found = _same(len(mesh.vertices), faces)
    else:
        found = numerics.projected(np.array(mesh.vertices), np.array(alignment.vertices), faces)
    became = mesh.vertex_of_input.astype(np.int64)
    kept = became >= 0
    return Projection(
        face=np.where(kept, found.face[became], -1),
        share=np.where(kept[:, None], found.share[became], 0.0),
        distance=np.where(kept, found.distance[became], np.nan),
    )


def _same(count: int, faces: Ints) -> numerics.Projection:
    """Fixed connectivity: every vertex is a corner of the first face around it."""
    corner = np.zeros(count, np.int64)
    used, first = np.unique(faces.ravel(), return_index=True)
    corner[used] = first
    share = np.zeros((count, 3))
    share[np.arange(count), corner % 3] = 1.0
    return numerics.Projection(corner // 3, share, np.zeros(count))
