"""What the joints of the 2014 paper were found by, drawn for the report."""

from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.annuli import Annuli
from kinetree.schemas.paper_2014.bones import Bones
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.integration import Integration
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.chapters import Drawn, Written, evidence_of
from kinetree.tasks.results.plots.mesoscopic import cones, lengths, merging, structure
from kinetree.tasks.views.paper_2014 import cone_consistency_remarks, integration_remarks


@task()
def paper_figures(
    middle: tuple[IntervalReference, ...],
    consistency: ConeConsistency,
    annuli: tuple[Annuli, ...],
    integration: Integration,
    cylinders: Cylinders,
    bones: Bones,
    skeleton: Skeleton,
    intervals: Intervals,
    up_direction: UpDirection,
) -> StructureFigures:
    """Draws cones and annuli, merge errors, areas and bones with the redundant ones (2014, Figs. 7, 11, 13 and 15)."""
    told: dict[str, Any] = {"cone_consistency": consistency, "integration": integration, "cylinders": cylinders, "bones": bones}
    told |= {"skeleton": skeleton, "intervals": intervals}
    count = len(consistency.ring)

    def fetch(name: str, interval: int = 0, cone: int = 0) -> Any:
        by_interval: dict[str, Any] = {"interval_reference": middle[interval]}
        if name == "annuli":
            return annuli[interval * count + cone]
        return by_interval[name] if name in by_interval else told[name]

    home, up = [middle[cylinders.interval].frame], up_direction.axis
    rings = [
        Drawn(
            cones(fetch, home, up),
            "The annuli of every cone, black beyond it; last, the areas they become: white is not rigid.",
            vector=False,
        )
    ]
    if count:
        caption = "What merging each annulus with the cluster before it costs (Eq. 12), and the choice of the threshold."
        rings.append(Drawn(merging(fetch, home, up), caption))
    links = [
        Drawn(structure(fetch, home, up), "Bones between areas that are not rigid, and the tree that is left.", vector=False),
        Drawn(lengths(fetch, home, up), "By what the lengths of bones vary before they are fixed; afterwards by nothing."),
    ]
    words = (*cone_consistency_remarks(consistency), *integration_remarks(integration))
    return evidence_of(
        [
            Written("cones", "Cones and annuli", rings, words),
            Written("bones", "Bones and redundant ones", links),
        ],
        np.full(len(skeleton.names), np.nan),
    )
