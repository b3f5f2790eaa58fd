"""How the joints were found, drawn as soon as the tree is there."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.derivation_figures import DerivationFigures
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import ArticulatedBody, Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.alternatives import cones_words, elimination_words, structure_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.derivation import cones, elimination, structure


@task()
def derivation_figures(
    rigid_parts: RigidParts, kinematic_tree: KinematicTree, sequence: Sequence, up_direction: UpDirection
) -> DerivationFigures:
    """Draws cones, elimination and the graph of parts, which wait for no pose and no name (2014, Figs. 7 and 15)."""
    unposed = unposed_skeleton(kinematic_tree, sequence)
    artifacts = {"skeleton": unposed, "rigid_parts": rigid_parts, "kinematic_tree": kinematic_tree}

    def fetch(name: str) -> Any:
        return artifacts[name]

    up = up_direction.axis
    figures = [
        CaptionedFigure(
            cones(fetch, [], up),
            "Cones around the leaves and their annuli; pale where cones overlap, which is cut as the trunk is.",
            cones_words(rigid_parts),
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
    ]
    return DerivationFigures(**rendered_figures(figures))


def unposed_skeleton(kinematic_tree: KinematicTree, sequence: Sequence) -> Skeleton:
    """The body before its poses are refined; no picture of its structure shows poses."""
    body = {name: getattr(kinematic_tree, name) for name in ArticulatedBody.model_fields}
    return Skeleton(**body, fps=sequence.fps, unit=sequence.unit)
