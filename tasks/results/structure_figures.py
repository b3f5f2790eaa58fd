"""How the joints were found, drawn for the report."""

from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import ArticulatedBody, Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.alternatives import (
    cones_words,
    elimination_words,
    lengths_words,
    merging_words,
    structure_words,
)
from kinetree.tasks.results.page.chapters import CaptionedFigure, FigureChapter, rendered_chapters
from kinetree.tasks.results.plots.derivation import cones, elimination, lengths, merging, structure
from kinetree.tasks.results.plots.timeline import joint_labels


@task()
def structure_figures(
    rigid_parts: RigidParts,
    kinematic_tree: KinematicTree,
    joint_names: JointNames,
    sequence: Sequence,
    up_direction: UpDirection,
) -> StructureFigures:
    """Draws cones, merge errors, elimination, the graph of parts and bones' lengths (2014, Figs. 7, 11 and 15)."""
    # no picture here shows poses
    body = {name: getattr(kinematic_tree, name) for name in ArticulatedBody.model_fields}
    unposed = Skeleton(**body, fps=sequence.fps, unit=sequence.unit)
    artifacts = {"skeleton": unposed, "rigid_parts": rigid_parts, "kinematic_tree": kinematic_tree, "joint_names": joint_names}

    def fetch(name: str) -> Any:
        return artifacts[name]

    up = up_direction.axis
    labels = joint_labels(fetch, unposed.names)
    figures = [
        CaptionedFigure(
            cones(fetch, [], up),
            "Cones around the leaves and their annuli; pale where cones overlap, which is cut as the trunk is.",
            cones_words(rigid_parts),
        ),
        CaptionedFigure(
            merging(fetch, [], up),
            "Cost of merging the annuli on both sides of each border, and the first cut; colours: parts of the final joints.",
            merging_words(rigid_parts),
        ),
        CaptionedFigure(
            elimination(fetch, [], up),
            "The first cut, the parts that remain of it, and what the removal of each other part cost.",
            elimination_words(rigid_parts),
        ),
        CaptionedFigure(
            structure(fetch, [], up),
            "The graph of parts before pruning, and the tree after it.",
            structure_words(unposed, kinematic_tree),
        ),
        CaptionedFigure(
            lengths(fetch, [], up),
            "Variation of bone lengths before they are fixed, 0 afterwards; orange: bones to joints, blue: to ends.",
            lengths_words(unposed, labels, np.asarray(kinematic_tree.length_variation)),
        ),
    ]
    return rendered_chapters([FigureChapter("derivation", "How joints were found", figures)], kinematic_tree.length_variation)
