"""The whole surface as areas of kinematic cones and cylinders."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.arap import Arap, by_interval
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.integration import Integration
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.paper_2014 import cylinders as numerics
from kinetree.tasks.numerics.paper_2014.transfer import composed_map


@task()
def cylinders(
    interval_references: tuple[IntervalReference, ...],
    alignments: tuple[Arap, ...],
    cone_consistency: ConeConsistency,
    cut_correspondence: CutCorrespondence,
    integration: Integration,
) -> Cylinders:
    """Extends cones into the undefined area, recursively, until all of the surface is defined (2014, Sec. 6.2)."""
    model = _model_interval(interval_references, cone_consistency)
    reference = interval_references[model]
    count, F = len(reference.vertices), reference.faces.astype(np.int64)
    of_cones = cone_consistency.annulus[:, cone_consistency.rows(model)].astype(np.int64)
    cones = numerics.kinematic_cones(of_cones, integration.rigid, reference.area)
    intervals = _motions(model, interval_references, alignments, cut_correspondence, integration.floor)

    def clustering(annuli: list[Ints]) -> Flags:
        at_least_rigid = integration.joint == "least_rigid"
        return numerics.rigid_annuli(annuli, intervals, integration.theta, count, at_least_rigid=at_least_rigid)

    distance = _leaf_distance(reference, cone_consistency.leaf[model].astype(np.int64))
    extensions = numerics.cylinders(cones, distance, reference.area, F, clustering, cone_consistency.annuli)
    annulus = np.full(count, -1)
    for cylinder in (*cones, *extensions):
        annulus = np.where(cylinder.annulus >= 0, cylinder.annulus, annulus)
    areas = numerics.areas([*cones, *extensions], count, F)
    return Cylinders(interval=model, cones=len(cones), annulus=annulus, **areas._asdict())


def _model_interval(references: tuple[IntervalReference, ...], cone_consistency: ConeConsistency) -> int:
    """The interval that sees the most cones; of these the one with the most frames, of these the first (ours)."""
    cones = (cone_consistency.leaf >= 0).sum(axis=1)
    return max(range(len(references)), key=lambda i: (cones[i], len(references[i].frames), -i))


def _motions(
    model: int,
    references: tuple[IntervalReference, ...],
    alignments: tuple[Arap, ...],
    cut_correspondence: CutCorrespondence,
    floor: float,
) -> list[numerics.IntervalMotion]:
    """Every interval's reference in its frames, and the vertices of the model mesh that correspond to its own."""
    maps, out = cut_correspondence.maps(), []
    for i, (reference, group) in enumerate(zip(references, by_interval(alignments, references), strict=True)):
        x = np.stack([a.vertices for a in group])
        model_vertex = composed_map(*maps, i, model, len(reference.vertices))
        out.append(numerics.IntervalMotion(x, model_vertex, floor * reference.size, all(a.is_rigid for a in group)))
    return out


def _leaf_distance(reference: IntervalReference, leaf: Ints) -> Floats:
    """(cone, vertex) distance from each cone's leaf; NaN for a cone that was recovered."""
    if not len(leaf):
        return np.zeros((0, len(reference.vertices)))
    return np.where((leaf >= 0)[:, None], reference.coordinates[leaf], np.nan)
