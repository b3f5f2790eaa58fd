"""The vertex of the finished skeleton's mesh at each of a frame's input vertices."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.alignment import Alignment
from kinetree.schemas.bones import Bones
from kinetree.schemas.consistency import Consistency
from kinetree.schemas.landing import Landing
from kinetree.schemas.mesh import Mesh
from kinetree.schemas.middle import Middle
from kinetree.tasks.numerics.mesoscopic.landing import landed


@task(over="interval/frame")
def landing(mesh: Mesh, middle: Middle, alignment: Alignment, consistency: Consistency, bones: Bones) -> Landing:
    """Goes over the interval's aligned mesh and the cuts to the mesh on which the skeleton is (ours, for 2014, Sec. 6.1.3)."""
    way = bones.way[consistency.rows(consistency.reference.index(middle.frame))].astype(np.int64)
    corner, distance = landed(mesh.vertices, alignment.vertices, middle.area, way)
    became = mesh.vertex_of_input.astype(np.int64)
    kept = became >= 0
    return Landing(corner=np.where(kept, corner[became], -1), distance=np.where(kept, distance[became], np.nan))
