"""How the joints were found, drawn as soon as the tree is there."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.derivation_figures import DerivationFigures
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.skeleton import ArticulatedBody, Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.alternatives import structure_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.derivation import structure


@task()
def derivation_figures(kinematic_tree: KinematicTree, sequence: Sequence, up_direction: UpDirection) -> DerivationFigures:
    """Draws the graph of parts, which waits for no pose and no name (2014, Fig. 15)."""
    unposed = unposed_skeleton(kinematic_tree, sequence)
    artifacts = {"skeleton": unposed, "kinematic_tree": kinematic_tree}

    def fetch(name: str) -> Any:
        return artifacts[name]

    graph = CaptionedFigure(
        structure(fetch, [], up_direction.axis),
        "The graph of parts before pruning, and the tree after it.",
        structure_words(unposed, kinematic_tree),
    )
    return DerivationFigures(**rendered_figures([graph]))


def unposed_skeleton(kinematic_tree: KinematicTree, sequence: Sequence) -> Skeleton:
    """The body before its poses are refined; no picture of its structure shows poses."""
    body = {name: getattr(kinematic_tree, name) for name in ArticulatedBody.model_fields}
    return Skeleton(**body, fps=sequence.fps, unit=sequence.unit)
