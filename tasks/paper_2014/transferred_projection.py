"""The way from every frame's input vertices to the mesh of the finished skeleton, in the form in which evaluation reads it."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.paper_2014.transfer import first_corners


@task(over="frame")
def transferred_projection(landing: tuple[Transfer, ...], skeleton: Skeleton) -> Projection:
    """Takes for every vertex of the user's file the corner of a face on which it lands (ours, for 2014, Sec. 6.1.3)."""
    (mine,) = landing  # a frame is in one interval
    face, share = first_corners(len(skeleton.vertices), skeleton.faces.astype(np.int64))
    at = np.maximum(mine.corner, 0)
    known = (mine.corner >= 0) & (face[at] >= 0)
    return Projection(
        face=np.where(known, face[at], -1),
        share=np.where(known[:, None], share[at], 0.0),
        distance=np.where(known, mine.distance, np.nan),
    )
