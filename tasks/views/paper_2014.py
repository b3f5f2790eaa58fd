"""Remarks on the results of the 2014 paper's own steps."""

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.integration import Integration


@remarks_of(CutCorrespondence)
def cut_correspondence_remarks(correspondence: CutCorrespondence) -> tuple[str, ...]:
    """Intervals whose reference has handles, and intervals with too few leaves to tell places apart."""
    few = ("no leaf", "one leaf", "two leaves")
    reason = "limbs touch or the body is a ring, and a tree of joints has no loop"
    handles = enumerate(correspondence.genus)
    loops = tuple(f"the reference of interval {i} has {n} handle{'s' * (n > 1)}: {reason}" for i, n in handles if n > 0)
    return loops + tuple(
        f"interval {i} has {few[n]}: the geodesic mapping cannot tell places apart there"
        for i, n in enumerate(correspondence.leaf_count.tolist())
        if n < len(few)
    )


@remarks_of(ConeConsistency)
def cone_consistency_remarks(consistency: ConeConsistency) -> tuple[str, ...]:
    """Cones that were recovered; or that there are no cones."""
    if not len(consistency.annulus):
        return ("no cones: no interval has a leaf; the body is taken as one rigid part",)
    return tuple(
        f"cone {cone} is not seen in interval {i} and was recovered from its neighbours"
        for i, row in enumerate(consistency.leaf)
        for cone, leaf in enumerate(row.tolist())
        if leaf < 0
    )


@remarks_of(Integration)
def integration_remarks(integration: Integration) -> tuple[str, ...]:
    """The threshold that was chosen; nothing if only one was given."""
    if len(integration.clusters) < 2:
        return ()
    rigid = integration.clusters.max()
    return (f"merge-error threshold {integration.theta:g}: it gives the most rigid areas, {rigid}",)
