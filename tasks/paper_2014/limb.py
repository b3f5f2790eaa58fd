"""One cone in one interval, apart from the others."""

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.paper_2014.limb import Limb


@task(over="interval/cone", along=ConeConsistency)
def limb(consistency: ConeConsistency, middle: IntervalReference, before: Limb | None) -> Limb:
    """Takes one cone of one interval, so that each is clustered by itself (2014, Sec. 6.1.1)."""
    number = before.number + 1 if before else 0
    interval = consistency.reference.index(middle.frame)
    return Limb(
        number=number,
        recovered=bool(consistency.leaf[interval, number] < 0),
        ring=consistency.ring[number, consistency.rows(interval)],
    )
