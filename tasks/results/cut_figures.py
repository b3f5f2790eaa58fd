"""How the body was cut, drawn as soon as its parts are there."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.results.cut_figures import CutFigures
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.alternatives import cones_words, elimination_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.derivation import cones, elimination


@task()
def cut_figures(reference: Reference, rigid_parts: RigidParts, up_direction: UpDirection) -> CutFigures:
    """Draws cones and elimination, which wait for no tree (2014, Fig. 7)."""
    artifacts = {"reference": reference, "rigid_parts": rigid_parts}

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
    ]
    return CutFigures(**rendered_figures(figures))
