"""Kinematic cones that hold in all intervals."""

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Bools
from kinetree.schemas.paper_2014.annuli import Annuli
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.integration import Integration
from kinetree.tasks.numerics.paper_2014.integration import integrated, most_clusters, rigid_areas


@task()
def integration(consistency: ConeConsistency, annuli: tuple[Annuli, ...]) -> Integration:
    """Makes an annulus a joint in all intervals if it is one in any (2014, Sec. 6.1.3; Fig. 12)."""
    cones = len(consistency.ring)
    length = int(consistency.ring.max(initial=-1)) + 1
    if not annuli:
        return Integration(floor=0.0, theta=0.0, rigid=np.ones((0, length), dtype=bool), clusters=np.zeros(0, np.int64))
    theta = annuli[0].theta
    every = np.array([[_cone(annuli[cone::cones], rung, length) for cone in range(cones)] for rung in range(len(theta))])
    last = consistency.ring.max(axis=1)
    count = np.array([sum(rigid_areas(r[: k + 1]) for r, k in zip(rows, last, strict=True)) for rows in every])
    order = np.argsort(theta, kind="stable")
    rung = int(order[most_clusters(count[order])])
    return Integration(floor=annuli[0].floor, theta=float(theta[rung]), rigid=every[rung], clusters=count)


def _cone(intervals: tuple[Annuli, ...], rung: int, length: int) -> Bools:
    """One cone at one threshold."""
    seen: list[NDArray[np.int64]] = [a.annulus.astype(np.int64) for a in intervals]
    return integrated(seen, [a.rigid[rung] for a in intervals], length)
