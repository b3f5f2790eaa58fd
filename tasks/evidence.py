"""What the joints were found by, drawn for the report."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.evidence import Evidence
from kinetree.schemas.skeleton import Skeleton
from kinetree.schemas.traces import Traces
from kinetree.schemas.upright import Upright
from kinetree.tasks.page.chapters import Drawn, Written, evidence_of
from kinetree.tasks.plots.traces import cones, lengths, merging, structure


@task()
def evidence(skeleton: Skeleton, traces: Traces, upright: Upright) -> Evidence:
    """Draws cones, merge errors, the graph of parts and bones' lengths (2014, Figs. 7, 11 and 15)."""
    told = {"skeleton": skeleton, "traces": traces}

    def fetch(name: str) -> Any:
        return told[name]

    up = upright.axis
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
