"""One set of cones for the whole sequence."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.cones import Cones
from kinetree.schemas.consistency import Consistency, ConsistencyParams
from kinetree.schemas.crossing import Crossing
from kinetree.schemas.middle import Middle
from kinetree.tasks.numerics.mesoscopic.limbs import Cut, Seen, limbs


@task()
def consistency(
    middle: tuple[Middle, ...], cones: tuple[Cones, ...], crossing: Crossing, params: ConsistencyParams
) -> Consistency:
    """Matches cones across intervals, rejects erroneous ones, recovers lost ones (2014, Sec. 6.1.1.2 to 6.1.1.4)."""
    seen = [Seen(c.ring.astype(np.int64), m.area, c.span) for m, c in zip(middle, cones, strict=True)]
    size = float(np.median([m.size for m in middle]))
    found = limbs(seen, cuts_of(crossing), params.leap * size)
    return Consistency(
        annuli=cones[0].annuli,
        reference=tuple(m.frame for m in middle),
        first=crossing.first,
        ring=np.concatenate(found.ring, axis=1),
        leaf=found.leaf,
    )


def cuts_of(crossing: Crossing) -> list[Cut]:
    """What is known of each cut."""
    out = []
    for i in range(len(crossing.first) - 1):
        at = crossing.cut == i
        onward, backward = crossing.onward[crossing.rows(i)], crossing.backward[crossing.rows(i + 1)]
        whole = [a.astype(np.int64) for a in (onward, backward, crossing.before[at], crossing.behind[at])]
        out.append(Cut(whole[0], whole[1], whole[2], whole[3], crossing.moved[at]))
    return out
