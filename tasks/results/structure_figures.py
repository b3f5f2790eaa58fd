"""How the joints were found, drawn for the report."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import ArticulatedBody, Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.chapters import CaptionedFigure, FigureChapter, rendered_chapters
from kinetree.tasks.results.plots.derivation import cones, elimination, lengths, merging, structure


@task()
def structure_figures(
    rigid_parts: RigidParts, kinematic_tree: KinematicTree, sequence: Sequence, up_direction: UpDirection
) -> StructureFigures:
    """Draws cones, merge errors, elimination, the graph of parts and bones' lengths (2014, Figs. 7, 11 and 15)."""
    # no picture here shows poses, so that nothing waits for those that are refined
    body = {name: getattr(kinematic_tree, name) for name in ArticulatedBody.model_fields}
    unposed = Skeleton(**body, fps=sequence.fps, unit=sequence.unit)
    artifacts = {"skeleton": unposed, "rigid_parts": rigid_parts, "kinematic_tree": kinematic_tree}

    def fetch(name: str) -> Any:
        return artifacts[name]

    up = up_direction.axis
    figures = [
        CaptionedFigure(
            cones(fetch, [], up),
            "Cones around the leaves and their annuli; pale where cones overlap, which is cut as the trunk is.",
            vector=False,
        ),
        CaptionedFigure(
            merging(fetch, [], up),
            "Cost of merging the annuli on both sides of each border, and the first cut; colours: parts of the final joints.",
        ),
        CaptionedFigure(
            elimination(fetch, [], up),
            "The first cut, the parts that remain of it, and what the removal of each other part cost.",
            vector=False,
        ),
        CaptionedFigure(structure(fetch, [], up), "The graph of parts before pruning, and the tree after it.", vector=False),
        CaptionedFigure(lengths(fetch, [], up), "Variation of bone lengths before they are fixed; afterwards there is none."),
    ]
    return rendered_chapters([FigureChapter("derivation", "How joints were found", figures)], kinematic_tree.length_variation)
