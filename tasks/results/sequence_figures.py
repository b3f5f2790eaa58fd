"""One sequence of a data set in figures and a small picture."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.schemas.results.sequence_figures import SequenceFigures
from kinetree.schemas.results.verdict import Verdict
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.evaluation.body import longest_side
from kinetree.tasks.numerics.results.thumbnail import thumbnail
from kinetree.tasks.results.formats.colours import part_colours
from kinetree.tasks.views.verdict import headline


@task(over="sequence")
def sequence_figures(
    skeleton: Skeleton, evaluation: Evaluation, frame_confidence: FrameConfidence, up_direction: UpDirection, verdict: Verdict
) -> SequenceFigures:
    """Sums up one sequence for a table over many (ours)."""
    summary = evaluation.summary
    scores = {name: getattr(summary, name, None) for name in ("scored", "found", "spurious", "error", "percent")}
    colours = part_colours(skeleton.label, skeleton.faces)[skeleton.label]
    return SequenceFigures(
        frames=len(skeleton.frames),
        unit=skeleton.unit,
        height=longest_side(skeleton.vertices),
        vertices=len(skeleton.vertices),
        joints=skeleton.kinds.count("joint"),
        leaves=skeleton.kinds.count("leaf"),
        bones=sum(parent >= 0 for parent in skeleton.parents),
        confidence=float(np.mean(skeleton.confidence)),
        outliers=int(np.sum(~np.asarray(frame_confidence.inlier))),
        verdict=verdict.level,
        verdict_words=headline(verdict),
        truth=evaluation.truth,
        picture=thumbnail(
            np.array(skeleton.vertices),
            np.array(skeleton.faces),
            colours,
            np.array(skeleton.rest),
            np.array(skeleton.parents),
            up_direction.axis,
        ),
        **scores,
    )
