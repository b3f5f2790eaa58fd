"""The model mesh's vertex at each of a frame's input vertices, and the model mesh's own vertices in that frame."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.bones import Bones
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.tasks.numerics.paper_2014.transfer import composed_map, mapped_positions, nearest_image


@task(over="interval/frame")
def transfer(
    index: Index,
    mesh: Mesh,
    interval_reference: IntervalReference,
    alignment: Arap,
    cut_correspondence: CutCorrespondence,
    cylinders: Cylinders,
    bones: Bones,
) -> Transfer:
    """Relates a frame to the model mesh over the interval's aligned mesh and the cuts (ours, for 2014, Sec. 6.1.3)."""
    interval = index[0]
    own_image = bones.model_vertex[cut_correspondence.rows(interval)].astype(np.int64)
    model_vertex, distance = nearest_image(mesh.vertices, alignment.vertices, interval_reference.area, own_image)
    cleaned = mesh.vertex_of_input.astype(np.int64)
    present = cleaned >= 0
    model_image = composed_map(*cut_correspondence.maps(), cylinders.interval, interval, len(cylinders.label))
    return Transfer(
        model_vertex=np.where(present, model_vertex[cleaned], -1),
        distance=np.where(present, distance[cleaned], np.nan),
        model_position=mapped_positions(alignment.vertices, model_image),
        tracked=interval_reference.tracked,
    )
