"""The annuli of one cone in one interval, clustered."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.paper_2014.annuli import Annuli, AnnuliParams
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.paper_2014.annuli import AnnulusClusters, annulus_clusters, least_rigid, self_errors


@task(over="interval/cone")
def annuli(
    index: Index,
    cone_consistency: ConeConsistency,
    interval_reference: IntervalReference,
    alignments: Mapping[int, Arap],
    params: AnnuliParams,
) -> Annuli:
    """Clusters annuli that move as one, from the leaf on, by the ratio of cast- to self-error (2014, Eqs. 9 to 12).

    The annulus of the leaf is rigid, as Sec. 6.1.2.3 assumes.
    If the reference lies on every frame of the interval as one rigid body, all annuli are rigid (ours): the ratio would only
    show the errors of the alignment.
    """
    interval, cone = index
    of_vertex = cone_consistency.annulus[cone, cone_consistency.rows(interval)]
    inside = np.flatnonzero(of_vertex >= 0)
    annulus = np.unique(of_vertex[inside])
    if all(a.is_rigid for a in alignments.values()):
        rungs = [AnnulusClusters(np.zeros(len(annulus), np.int64), np.ones(len(annulus)))] * len(params.thresholds)
        rigid = np.ones((len(rungs), len(annulus)), dtype=bool)
    else:
        x = np.stack([a.vertices[inside] for a in alignments.values()])
        moving = [np.ascontiguousarray(x[:, of_vertex[inside] == k]) for k in annulus]
        floor = params.floor * interval_reference.size
        rungs = annulus_clusters(moving, params.thresholds, floor)
        rigid = np.array([r.rigid for r in rungs]).reshape(len(rungs), len(annulus))
        rigid[:, annulus == 0] = True
        if params.joint == "least_rigid":
            error = self_errors(moving)
            rigid = np.array([least_rigid(r, error) for r in rigid])
    return Annuli(
        interval=interval,
        cone=cone,
        floor=params.floor,
        joint=params.joint,
        theta=np.array(params.thresholds),
        annulus=annulus,
        rigid=rigid,
        merge_error=np.array([r.merge_error for r in rungs]).reshape(len(rungs), len(annulus)),
    )
