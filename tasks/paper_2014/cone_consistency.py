"""One set of cones for the whole sequence."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency, ConeConsistencyParams
from kinetree.schemas.paper_2014.cones import Cones
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.paper_2014.cone_consistency import Cut, IntervalCones, consistent_cones


@task()
def cone_consistency(
    interval_references: tuple[IntervalReference, ...],
    cones: tuple[Cones, ...],
    cut_correspondence: CutCorrespondence,
    params: ConeConsistencyParams,
) -> ConeConsistency:
    """Matches cones across intervals, rejects erroneous ones, recovers lost ones (2014, Sec. 6.1.1.2 to 6.1.1.4)."""
    intervals = [
        IntervalCones(c.annulus.astype(np.int64), r.area, c.mu_range) for r, c in zip(interval_references, cones, strict=True)
    ]
    size = float(np.median([r.size for r in interval_references]))
    consistent = consistent_cones(intervals, _cuts(cut_correspondence), params.leap * size)
    return ConeConsistency(
        annuli=cones[0].annuli,
        first=cut_correspondence.first,
        annulus=np.concatenate(consistent.annulus, axis=1),
        leaf=consistent.leaf,
    )


def _cuts(cut_correspondence: CutCorrespondence) -> list[Cut]:
    """The cuts as numerics have them."""
    out = []
    for i, (to_next, to_previous) in enumerate(zip(*cut_correspondence.maps(), strict=True)):
        here = cut_correspondence.cut == i
        before, after = (a[here].astype(np.int64) for a in (cut_correspondence.leaf_before, cut_correspondence.leaf_after))
        out.append(Cut(to_next, to_previous, before, after, cut_correspondence.leaf_distance[here]))
    return out
