"""How the joints were found: the pictures of three tasks in the order of a chapter."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.cut_figures import CutFigures
from kinetree.schemas.results.derivation_figures import DerivationFigures
from kinetree.schemas.results.named_figures import NamedFigures
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.tasks.results.page.chapters import FigureChapter, drawn_before, rendered_chapters


@task()
def structure_figures(
    kinematic_tree: KinematicTree,
    cut_figures: CutFigures,
    derivation_figures: DerivationFigures,
    named_figures: NamedFigures,
) -> StructureFigures:
    """Puts cones, merge errors, elimination, the graph of parts and bones' lengths in order (2014, Figs. 7, 11 and 15)."""
    cones, elimination = drawn_before(cut_figures)
    (structure,) = drawn_before(derivation_figures)
    merging, lengths = drawn_before(named_figures)
    chapter = FigureChapter("derivation", "How joints were found", [cones, merging, elimination, structure, lengths])
    return rendered_chapters([chapter], kinematic_tree.length_variation)
