"""What people see of the 2014 paper's own steps."""

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.integration import Integration


@remarks_of(CutCorrespondence)
def cut_correspondence_remarks(correspondence: CutCorrespondence) -> tuple[str, ...]:
    """Said where there are too few leaves to tell places apart."""
    few = ("no leaf", "one leaf", "two leaves")
    closed = "as a ring has or limbs that touch: a tree of joints cannot close it"
    handles = enumerate(correspondence.handles)
    rings = tuple(f"interval {i} has {n} handle{'s' * (n > 1)}, {closed}" for i, n in handles if n > 0)
    return rings + tuple(
        f"interval {i} has {few[n]}: the geodesic mapping cannot tell places apart there"
        for i, n in enumerate(correspondence.leaves.tolist())
        if n < len(few)
    )


@remarks_of(ConeConsistency)
def cone_consistency_remarks(consistency: ConeConsistency) -> tuple[str, ...]:
    """Which cones had to be recovered, and that there are none."""
    if not len(consistency.ring):
        return ("no cones: no interval has a leaf; the body is taken as one rigid part",)
    return tuple(
        f"cone {cone} is not seen in interval {i} and was recovered from its neighbours"
        for i, row in enumerate(consistency.leaf)
        for cone, leaf in enumerate(row.tolist())
        if leaf < 0
    )


@remarks_of(Integration)
def integration_remarks(integration: Integration) -> tuple[str, ...]:
    """The threshold, where it was chosen."""
    if len(integration.clusters) < 2:
        return ()
    rigid = integration.clusters.max()
    return (f"merge-error threshold {integration.theta:g}: it gives the most rigid areas, {rigid}",)
