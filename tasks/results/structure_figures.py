"""How the joints were found, drawn for the report."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.chapters import Drawn, Written, evidence_of
from kinetree.tasks.results.plots.derivation import cones, elimination, lengths, merging, structure


@task()
def structure_figures(
    skeleton: Skeleton, rigid_parts: RigidParts, kinematic_tree: KinematicTree, up_direction: UpDirection
) -> StructureFigures:
    """Draws cones, merge errors, elimination, the graph of parts and bones' lengths (2014, Figs. 7, 11 and 15)."""
    artifacts = {"skeleton": skeleton, "rigid_parts": rigid_parts, "kinematic_tree": kinematic_tree}

    def fetch(name: str) -> Any:
        return artifacts[name]

    up = up_direction.axis
    drawn = [
        Drawn(
            cones(fetch, [], up),
            "Cones around the leaves and their annuli; pale: several, cut as the trunk is.",
            vector=False,
        ),
        Drawn(
            merging(fetch, [], up),
            "What merging annuli across each border would cost, and the first cut; coloured: joints' parts at the end.",
        ),
        Drawn(
            elimination(fetch, [], up),
            "The first cut, the parts that were left of it, and what removing each of the others cost.",
            vector=False,
        ),
        Drawn(structure(fetch, [], up), "The graph of parts before pruning, and the tree after it.", vector=False),
        Drawn(lengths(fetch, [], up), "How much bones' lengths varied before they were held; afterwards they do not."),
    ]
    return evidence_of([Written("evidence", "How joints were found", drawn)], kinematic_tree.length_variation)
