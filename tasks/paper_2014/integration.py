"""Kinematic cones that hold in all intervals."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.annuli import Annuli
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.integration import Integration
from kinetree.tasks.numerics.arrays import Flags
from kinetree.tasks.numerics.paper_2014.integration import integrated, most_clusters, rigid_areas


@task()
def integration(cone_consistency: ConeConsistency, annuli: tuple[Annuli, ...]) -> Integration:
    """Makes an annulus non-rigid in all intervals if it is so in any (2014, Sec. 6.1.3; Fig. 12)."""
    cones, last = len(cone_consistency.annulus), cone_consistency.annulus.max(axis=1, initial=-1)
    length = int(last.max(initial=-1)) + 1
    if not annuli:
        none = np.zeros(0, np.int64)
        return Integration(floor=0.0, joint="clustered", theta=0.0, rigid=np.ones((0, length), dtype=bool), clusters=none)
    theta = annuli[0].theta
    by_cone = [[a for a in annuli if a.cone == cone] for cone in range(cones)]
    rigid = np.array([[_integrated(own, rung, length) for own in by_cone] for rung in range(len(theta))])
    clusters = np.array([sum(rigid_areas(r[: k + 1]) for r, k in zip(rows, last, strict=True)) for rows in rigid])
    order = np.argsort(theta, kind="stable")
    rung = int(order[most_clusters(clusters[order])])
    floor, joint = annuli[0].floor, annuli[0].joint
    return Integration(floor=floor, joint=joint, theta=float(theta[rung]), rigid=rigid[rung], clusters=clusters)


def _integrated(intervals: list[Annuli], rung: int, length: int) -> Flags:
    """(annulus,) whether each annulus of one cone is rigid in all intervals, at one threshold."""
    annulus = [a.annulus.astype(np.int64) for a in intervals]
    return integrated(annulus, [a.rigid[rung] for a in intervals], length)
