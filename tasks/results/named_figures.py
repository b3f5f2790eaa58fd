"""How the joints were found, drawn where pictures show their names."""

from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.named_figures import NamedFigures
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.derivation_figures import unposed_skeleton
from kinetree.tasks.results.page.alternatives import lengths_words, merging_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.derivation import lengths, merging
from kinetree.tasks.results.plots.timeline import joint_labels


@task()
def named_figures(
    rigid_parts: RigidParts,
    kinematic_tree: KinematicTree,
    joint_names: JointNames,
    sequence: Sequence,
    up_direction: UpDirection,
) -> NamedFigures:
    """Draws merge errors and bones' lengths (2014, Figs. 11 and 15)."""
    unposed = unposed_skeleton(kinematic_tree, sequence)
    artifacts = {"skeleton": unposed, "rigid_parts": rigid_parts, "kinematic_tree": kinematic_tree, "joint_names": joint_names}

    def fetch(name: str) -> Any:
        return artifacts[name]

    up = up_direction.axis
    labels = joint_labels(fetch, unposed.names)
    merged = CaptionedFigure(
        merging(fetch, [], up),
        "Cost of merging the annuli on both sides of each border, and the first cut; colours: parts of the final joints.",
        merging_words(rigid_parts),
    )
    variation = CaptionedFigure(
        lengths(fetch, [], up),
        "Variation of bone lengths before they are fixed, 0 afterwards; orange: bones to joints, blue: to ends.",
        lengths_words(unposed, labels, np.asarray(kinematic_tree.length_variation)),
    )
    return NamedFigures(**rendered_figures([merged, variation]))
