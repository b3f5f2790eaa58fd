"""Joints and the bones between them."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.arap import Arap, by_interval
from kinetree.schemas.paper_2014.bones import Bones
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.paper_2014 import bones as numerics
from kinetree.tasks.numerics.paper_2014.cylinders import Areas
from kinetree.tasks.numerics.paper_2014.transfer import composed_map


@task()
def bones(
    interval_references: tuple[IntervalReference, ...],
    alignments: tuple[Arap, ...],
    cone_consistency: ConeConsistency,
    cut_correspondence: CutCorrespondence,
    cylinders: Cylinders,
) -> Bones:
    """Places joints at centroids of non-rigid areas, joins them by bones, finds redundant bones (2014, Sec. 6.3; Fig. 15)."""
    model, areas = cylinders.interval, _areas(cylinders)
    maps, groups = cut_correspondence.maps(), by_interval(alignments, interval_references)
    centroids, model_vertices = [], []
    for i, (reference, group) in enumerate(zip(interval_references, groups, strict=True)):
        model_vertices.append(composed_map(*maps, i, model, len(reference.vertices)))
        annulus = cone_consistency.annulus[:, cone_consistency.rows(i)].astype(np.int64)
        label = numerics.interval_labels(areas, cylinders.cones, annulus, model_vertices[-1])
        x = np.stack([a.vertices for a in group])
        centroids.append(numerics.area_centroids(x, label, reference.area, len(areas.rigid)))
    centroid = np.concatenate(centroids)
    faces = interval_references[model].faces.astype(np.int64)
    return Bones(
        frames=tuple(t for reference in interval_references for t in reference.frames),
        centroid=centroid,
        model_vertex=np.concatenate(model_vertices),
        **numerics.bones(areas.label, areas.rigid, faces, centroid)._asdict(),
    )


def _areas(cylinders: Cylinders) -> Areas:
    """The areas as numerics have them."""
    c = cylinders
    label, cylinder, first, last = (a.astype(np.int64) for a in (c.label, c.cylinder, c.first_annulus, c.last_annulus))
    return Areas(label, np.array(c.rigid), cylinder, first, last)
