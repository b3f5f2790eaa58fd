"""Views of the artifacts of the shelf `paper_2014`."""

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.integration import Integration


@remarks_of(CutCorrespondence)
def cut_correspondence_remarks(correspondence: CutCorrespondence) -> tuple[str, ...]:
    """Says where the surface has handles, and where there are too few leaves for geodesic coordinates."""
    counts = ("no leaf", "one leaf", "two leaves")
    reason = "where limbs touch or the body forms a ring; a tree of joints cannot represent a closed loop"
    handles = enumerate(correspondence.genus)
    closed = tuple(f"the surface of interval {i} has {n} handle{'s' * (n > 1)}, {reason}" for i, n in handles if n > 0)
    return closed + tuple(
        f"interval {i} has {counts[n]}; geodesic coordinates need three to distinguish points, so its mapping is unreliable"
        for i, n in enumerate(correspondence.leaf_count.tolist())
        if n < len(counts)
    )


@remarks_of(ConeConsistency)
def cone_consistency_remarks(consistency: ConeConsistency) -> tuple[str, ...]:
    """Says which cones were recovered, or that there are none."""
    if not len(consistency.annulus):
        return ("no cones, because no interval has a leaf; the body is treated as one rigid part",)
    return tuple(
        f"cone {cone} is missing in interval {i}; it was recovered from the neighbouring intervals"
        for i, row in enumerate(consistency.leaf)
        for cone, leaf in enumerate(row.tolist())
        if leaf < 0
    )


@remarks_of(Integration)
def integration_remarks(integration: Integration) -> tuple[str, ...]:
    """The threshold of the merge error, where it was chosen among several."""
    if len(integration.clusters) < 2:
        return ()
    most = integration.clusters.max()
    return (f"threshold of the merge error: {integration.theta:g}, which gives the most rigid areas, {most}",)
