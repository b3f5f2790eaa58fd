"""The joints of the 2014 paper and how they were found, drawn for the report."""

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
from kinetree.tasks.results.page.chapters import CaptionedFigure, FigureChapter, rendered_chapters
from kinetree.tasks.results.plots.mesoscopic import cones, lengths, merging, structure
from kinetree.tasks.views.paper_2014 import cone_consistency_remarks, integration_remarks


@task()
def paper_figures(
    interval_references: tuple[IntervalReference, ...],
    cone_consistency: ConeConsistency,
    annuli: tuple[Annuli, ...],
    integration: Integration,
    cylinders: Cylinders,
    bones: Bones,
    skeleton: Skeleton,
    intervals: Intervals,
    up_direction: UpDirection,
) -> StructureFigures:
    """Draws cones and annuli, merge errors, areas and bones with the redundant ones (2014, Figs. 7, 11, 13 and 15)."""
    artifacts: dict[str, Any] = {"cone_consistency": cone_consistency, "integration": integration, "cylinders": cylinders}
    artifacts |= {"bones": bones, "skeleton": skeleton, "intervals": intervals}
    of_cone = {(a.interval, a.cone): a for a in annuli}

    def fetch(name: str, interval: int = 0, cone: int = 0) -> Any:
        if name == "annuli":
            return of_cone[interval, cone]
        return interval_references[interval] if name == "interval_reference" else artifacts[name]

    size = interval_references[cylinders.interval].size
    frames, up = [interval_references[cylinders.interval].frame], up_direction.axis
    annulus_figures = [
        CaptionedFigure(
            cones(fetch, frames, up),
            "The annuli of every cone, grey beyond it; last, the areas they become: white is not rigid.",
            f"{len(cone_consistency.annulus)} cones on the body; {int(cylinders.rigid.sum())} rigid areas and"
            f" {int((~cylinders.rigid).sum())} that are not.",
        )
    ]
    if len(cone_consistency.annulus):
        caption = "Merge-error of each annulus with the cluster before it (Eq. 12), and the choice of the threshold."
        annulus_figures.append(
            CaptionedFigure(merging(fetch, frames, up), caption, f"The threshold that was chosen is {integration.theta:.3g}.")
        )
    bone_figures = [
        CaptionedFigure(
            structure(fetch, frames, up),
            "Bones between non-rigid areas, and the tree without redundant bones.",
            f"{len(bones.bone)} bones, {int((~bones.in_tree).sum())} of them redundant;"
            f" {skeleton.kinds.count('joint')} joints in the tree.",
        ),
        CaptionedFigure(
            lengths(fetch, frames, up),
            "Variation of the lengths of bones before they are fixed; afterwards there is none.",
            f"Bars of {int(np.isfinite(bones.variation).sum())} bones; the widest is"
            f" {100 * np.nanmax(bones.variation, initial=0.0) / size:.2g} % of the root of the area.",
        ),
    ]
    words = (*cone_consistency_remarks(cone_consistency), *integration_remarks(integration))
    return rendered_chapters(
        [
            FigureChapter("cones", "Cones and annuli", annulus_figures, words),
            FigureChapter("bones", "Bones and redundant ones", bone_figures),
        ],
        np.full(len(skeleton.names), np.nan),
    )
