"""One set of cones for the whole sequence."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency, ConeConsistencyParams
from kinetree.schemas.paper_2014.cones import Cones
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.paper_2014.cone_consistency import Cut, Seen, limbs


@task()
def cone_consistency(
    middle: tuple[IntervalReference, ...], cones: tuple[Cones, ...], crossing: CutCorrespondence, params: ConeConsistencyParams
) -> ConeConsistency:
    """Matches cones across intervals, rejects erroneous ones, recovers lost ones (2014, Sec. 6.1.1.2 to 6.1.1.4)."""
    seen = [Seen(c.ring.astype(np.int64), m.area, c.span) for m, c in zip(middle, cones, strict=True)]
    size = float(np.median([m.size for m in middle]))
    found = limbs(seen, cuts_of(crossing), params.leap * size)
    return ConeConsistency(
        annuli=cones[0].annuli,
        reference=tuple(m.frame for m in middle),
        first=crossing.first,
        ring=np.concatenate(found.ring, axis=1),
        leaf=found.leaf,
    )


def cuts_of(crossing: CutCorrespondence) -> list[Cut]:
    """What is known of each cut."""
    out = []
    for i in range(len(crossing.first) - 1):
        at = crossing.cut == i
        onward, backward = crossing.onward[crossing.rows(i)], crossing.backward[crossing.rows(i + 1)]
        whole = [a.astype(np.int64) for a in (onward, backward, crossing.before[at], crossing.behind[at])]
        out.append(Cut(whole[0], whole[1], whole[2], whole[3], crossing.moved[at]))
    return out
