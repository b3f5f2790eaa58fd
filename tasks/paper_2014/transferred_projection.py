"""Every frame's input vertices on the mesh of the skeleton, as the projection that every method ends with."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.paper_2014.transferred_projection import first_corners


@task(over="frame")
def transferred_projection(transfers: tuple[Transfer, ...], skeleton: Skeleton) -> Projection:
    """Takes for every vertex of the user's file a face's corner at its vertex of the model (ours, for 2014, Sec. 6.1.3)."""
    (transfer,) = transfers  # a frame is in one interval
    face, share = first_corners(len(skeleton.vertices), skeleton.faces.astype(np.int64))
    vertex = np.maximum(transfer.model_vertex, 0)
    known = (transfer.model_vertex >= 0) & (face[vertex] >= 0)
    return Projection(
        face=np.where(known, face[vertex], -1),
        share=np.where(known[:, None], share[vertex], 0.0),
        distance=np.where(known, transfer.distance, np.nan),
    )
