"""What the joints were found by, drawn for the report."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.structure.traces import Traces
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.chapters import Drawn, Written, evidence_of
from kinetree.tasks.results.plots.traces import cones, lengths, merging, structure


@task()
def structure_figures(skeleton: Skeleton, traces: Traces, up_direction: UpDirection) -> StructureFigures:
    """Draws cones, merge errors, the graph of parts and bones' lengths (2014, Figs. 7, 11 and 15)."""
    told = {"skeleton": skeleton, "traces": traces}

    def fetch(name: str) -> Any:
        return told[name]

    up = up_direction.axis
    drawn = [
        Drawn(cones(fetch, [], up), "Cones around the leaves and their annuli; pale where cones overlap.", vector=False),
        Drawn(
            merging(fetch, [], up),
            "What merging annuli across each border would cost, and the first cut; coloured: parts left, white: shared annuli.",
        ),
        Drawn(structure(fetch, [], up), "The graph of parts before, and the tree that was left.", vector=False),
        Drawn(lengths(fetch, [], up), "By what bones' lengths varied before they were held; afterwards by nothing."),
    ]
    return evidence_of([Written("evidence", "What joints were found by", drawn)], traces.variation)
