"""The graphs of the 2009 paper and the structure made of them, drawn for the report."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervals
from kinetree.schemas.paper_2009.contact_kinds import ContactKinds
from kinetree.schemas.paper_2009.graph_motion import GraphMotion
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.schemas.paper_2009.perg import Perg
from kinetree.schemas.paper_2009.reeb_graph import ReebGraph
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.scene import evenly_spread
from kinetree.tasks.results.page.chapters import CaptionedFigure, FigureChapter, rendered_chapters
from kinetree.tasks.results.plots.reeb import clusters, coherence, description, endoskeleton
from kinetree.tasks.views.paper_2009 import coherent_intervals_remarks, contact_kinds_remarks

SHOWN = 4
"""Frames in which the structure is drawn."""


@task()
def reeb_figures(
    integrated_structure: IntegratedStructure,
    coherent_intervals: CoherentIntervals,
    contact_kinds: ContactKinds,
    kinematic_tree: KinematicTree,
    up_direction: UpDirection,
    sequence: Sequence,
    reeb_graph: Mapping[int, ReebGraph],
    perg: Mapping[int, Perg],
    graph_motion: Mapping[int, GraphMotion],
    mesh: Mapping[int, Mesh],
) -> StructureFigures:
    """Draws graphs inside the body, coherent intervals, clusters and the structure in some frames (2009, Figs. 1 to 4, 6)."""
    of_sequence = {"integrated_structure": integrated_structure, "coherent_intervals": coherent_intervals, "sequence": sequence}
    by_frame = {"reeb_graph": reeb_graph, "perg": perg, "graph_motion": graph_motion, "mesh": mesh}

    def fetch(name: str, frame: int | None = None) -> Any:
        return of_sequence[name] if frame is None else by_frame[name][frame]

    up = up_direction.axis
    frames = [coherent_intervals.frames[t] for t in evenly_spread(len(coherent_intervals.frames), SHOWN)]
    graphs = [
        CaptionedFigure(
            endoskeleton(fetch, [], up),
            "The Reeb graph of μ, and the graph inside the body (2009, Fig. 1).",
            _nodes(perg[integrated_structure.frame]),
        ),
        CaptionedFigure(
            coherence(fetch, [], up),
            "Ends and loops of every frame's graph; coherent intervals are shaded.",
            _coherent(coherent_intervals),
        ),
    ]
    structure = [
        CaptionedFigure(
            clusters(fetch, [], up),
            "Correlation of velocities (Eq. 5), and clusters that move as one (Fig. 2).",
            _clusters(integrated_structure),
        ),
        CaptionedFigure(
            description(fetch, frames, up),
            "The integrated structure in some frames (Figs. 4 and 6).",
            f"The structure over the body in frames {', '.join(map(str, frames))}.",
        ),
    ]
    variation = kinematic_tree.length_variation
    words = (*coherent_intervals_remarks(coherent_intervals), *contact_kinds_remarks(contact_kinds))
    return rendered_chapters(
        [
            FigureChapter("graphs", "Graphs inside the body", graphs, words),
            FigureChapter("clusters", "Clusters of nodes", structure),
        ],
        variation if variation.any() else np.full(len(variation), np.nan),
    )


def _nodes(inner: Perg) -> str:
    """What the picture of the graphs shows, in words."""
    return f"The graph inside the body has {len(inner.node)} nodes and {len(inner.edge)} edges."


def _coherent(runs: CoherentIntervals) -> str:
    """What the picture of the intervals shows, in words."""
    spans = ", ".join(f"{runs.frames[int(a)]}–{runs.frames[int(b)]}" for a, b in zip(runs.begin, runs.end, strict=True))
    return f"Between {int(runs.ends.min())} and {int(runs.ends.max())} ends; coherent in frames {spans or 'nowhere'}."


def _clusters(model: IntegratedStructure) -> str:
    """What the picture of the clusters shows, in words."""
    return f"{len(model.node)} nodes in {len(np.unique(model.cluster))} clusters that move as one."
