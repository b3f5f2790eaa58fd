"""The vertex of the finished skeleton's mesh at each of a frame's input vertices, and where its own vertices are there."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.bones import Bones
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.tasks.numerics.paper_2014.across_cuts import carried, way
from kinetree.tasks.numerics.paper_2014.transfer import landed
from kinetree.tasks.paper_2014.cone_consistency import cuts_of


@task(over="interval/frame")
def transfer(
    mesh: Mesh,
    middle: IntervalReference,
    alignment: Arap,
    consistency: ConeConsistency,
    crossing: CutCorrespondence,
    cylinders: Cylinders,
    bones: Bones,
) -> Transfer:
    """Goes over the interval's aligned mesh and the cuts to the mesh on which the skeleton is (ours, for 2014, Sec. 6.1.3)."""
    interval, home = consistency.reference.index(middle.frame), cylinders.interval
    back = bones.way[consistency.rows(interval)].astype(np.int64)
    corner, distance = landed(mesh.vertices, alignment.vertices, middle.area, back)
    became = mesh.vertex_of_input.astype(np.int64)
    kept = became >= 0
    cuts = cuts_of(crossing)
    onto = way([c.onward for c in cuts], [c.backward for c in cuts], home, interval, len(cylinders.label))
    return Transfer(
        corner=np.where(kept, corner[became], -1),
        distance=np.where(kept, distance[became], np.nan),
        place=carried(alignment.vertices, onto),
    )
