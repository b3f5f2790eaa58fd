"""The annuli of one cone in one interval, clustered."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.annuli import Annuli, AnnuliParams
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.paper_2014.limb import Limb
from kinetree.tasks.numerics.paper_2014.annuli import Clustered, clustered


@task(over="interval/cone")
def annuli(limb: Limb, middle: IntervalReference, alignment: Mapping[int, Arap], params: AnnuliParams) -> Annuli:
    """Clusters annuli that move as one, from the leaf on, by the ratio of cast- to self-error (2014, Eqs. 9 to 12).

    Where the whole body lies on every frame of the interval as one rigid thing, all annuli are rigid: the ratio would tell of
    what the alignment errs by.
    """
    used = np.unique(limb.ring[limb.ring >= 0])
    inside = np.flatnonzero(limb.ring >= 0)
    x = np.stack([a.vertices[inside] for a in alignment.values()])
    parts = [np.ascontiguousarray(x[:, limb.ring[inside] == k]) for k in used]
    still = all(a.still for a in alignment.values())
    at_rest = Clustered(np.zeros(len(used), np.int64), np.ones(len(used)))
    found = [at_rest if still else clustered(parts, theta, params.floor * middle.size) for theta in params.thresholds]
    return Annuli(
        floor=params.floor,
        theta=np.array(params.thresholds),
        annulus=used,
        rigid=np.array([f.rigid | still for f in found]).reshape(len(found), len(used)),
        merge=np.array([f.merge for f in found]).reshape(len(found), len(used)),
    )
