"""Topology over time, drawn for the report."""

from collections.abc import Mapping
from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.excerpt import Excerpt
from kinetree.schemas.results.topology_figures import TopologyFigures
from kinetree.schemas.topology.correlation import Correlation
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.alternatives import correlation_words, mu_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.macroscopic import correlation as correlation_figure
from kinetree.tasks.results.plots.macroscopic import mu as mu_figure


@task()
def topology_figures(
    excerpt: Excerpt,
    sequence: Sequence,
    correlation: Correlation,
    intervals: Intervals,
    leaves: Leaves,
    up_direction: UpDirection,
    mesh: Mapping[int, Mesh],
    geodesics: Mapping[int, Geodesics],
) -> TopologyFigures:
    """Draws the correlation with the intervals, and μ on the surface (2014, Figs. 4 and 5)."""
    of_sequence = {"sequence": sequence, "correlation": correlation, "intervals": intervals, "leaves": leaves}
    by_frame = {"mesh": mesh, "geodesics": geodesics}

    def fetch(name: str, frame: int | None = None) -> Any:
        return of_sequence[name] if frame is None else by_frame[name][frame]

    frames, up = list(excerpt.pictured), up_direction.axis
    figures = [
        CaptionedFigure(
            correlation_figure(fetch, frames, up),
            "Correlation C(t) (Eq. 2) with cuts and intervals; below, every cue relative to its threshold.",
            correlation_words(correlation, intervals),
        ),
        CaptionedFigure(
            mu_figure(fetch, frames, up),
            "μ on the surface, from low (dark) to high (bright), with the leaves.",
            mu_words(leaves, frames),
        ),
    ]
    return TopologyFigures(**rendered_figures(figures))
