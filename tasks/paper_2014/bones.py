"""Joints and the bones between them."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.bones import Bones
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.paper_2014 import bones as numerics
from kinetree.tasks.numerics.paper_2014.across_cuts import centroids, labels
from kinetree.tasks.paper_2014.cylinders import motions, ways_to


@task()
def bones(
    middle: tuple[IntervalReference, ...],
    alignment: tuple[Arap, ...],
    consistency: ConeConsistency,
    crossing: CutCorrespondence,
    cylinders: Cylinders,
) -> Bones:
    """Places joints at the middle of areas that are not rigid, joins them, drops redundant bones (2014, Sec. 6.3; Fig. 15)."""
    whole = areas_of(cylinders)
    count, F = len(whole.rigid), middle[cylinders.interval].faces.astype(np.int64)
    ways = ways_to(cylinders.interval, middle, crossing)
    places = []
    for i, (m, x, back) in enumerate(zip(middle, motions(middle, alignment), ways, strict=True)):
        ring = consistency.ring[:, consistency.rows(i)].astype(np.int64)
        places.append(centroids(x, labels(whole, cylinders.cones, ring, back), m.area, count))
    centroid = np.concatenate(places)
    meets = numerics.adjacent(whole.label, F, count)
    body = numerics.bodies(meets, whole.rigid)
    pair, carrier = numerics.candidates(meets, body)
    kept = np.isin(np.arange(len(pair)), numerics.without_redundant(centroid, pair))
    return Bones(
        frames=tuple(t for m in middle for t in m.frames),
        body=body,
        centroid=centroid,
        bone=pair,
        carrier=carrier,
        variation=numerics.variation(centroid, pair),
        kept=kept,
        way=np.concatenate(ways),
    )


def areas_of(cylinders: Cylinders) -> numerics.Areas:
    """The areas as numerics have them."""
    c = cylinders
    label, piece, first, last = (a.astype(np.int64) for a in (c.label, c.piece, c.first, c.last))
    return numerics.Areas(label, np.array(c.rigid), piece, first, last)
