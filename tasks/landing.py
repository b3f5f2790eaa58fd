"""The vertex of the finished skeleton's mesh at each of a frame's input vertices, and where its own vertices are there."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.arap import Arap
from kinetree.schemas.bones import Bones
from kinetree.schemas.consistency import Consistency
from kinetree.schemas.crossing import Crossing
from kinetree.schemas.cylinders import Cylinders
from kinetree.schemas.landing import Landing
from kinetree.schemas.mesh import Mesh
from kinetree.schemas.middle import Middle
from kinetree.tasks.consistency import cuts_of
from kinetree.tasks.numerics.mesoscopic.landing import landed
from kinetree.tasks.numerics.mesoscopic.transfer import carried, way


@task(over="interval/frame")
def landing(
    mesh: Mesh,
    middle: Middle,
    alignment: Arap,
    consistency: Consistency,
    crossing: Crossing,
    cylinders: Cylinders,
    bones: Bones,
) -> Landing:
    """Goes over the interval's aligned mesh and the cuts to the mesh on which the skeleton is (ours, for 2014, Sec. 6.1.3)."""
    interval, home = consistency.reference.index(middle.frame), cylinders.interval
    back = bones.way[consistency.rows(interval)].astype(np.int64)
    corner, distance = landed(mesh.vertices, alignment.vertices, middle.area, back)
    became = mesh.vertex_of_input.astype(np.int64)
    kept = became >= 0
    cuts = cuts_of(crossing)
    onto = way([c.onward for c in cuts], [c.backward for c in cuts], home, interval, len(cylinders.label))
    return Landing(
        corner=np.where(kept, corner[became], -1),
        distance=np.where(kept, distance[became], np.nan),
        place=carried(alignment.vertices, onto),
    )
