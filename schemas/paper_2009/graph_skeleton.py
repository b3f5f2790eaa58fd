"""How clusters become the joints of a skeleton (2009, Sec. 2.4)."""

from typing import Literal

from kinetree.schemas.structure.kinematic_tree import KinematicTreeParams


class GraphSkeletonParams(KinematicTreeParams):
    """Where joints are, and what counts as one where they are rotation centres."""

    joints: Literal["centres", "edges"] = "centres"
    """centres: where two clusters turn about each other; edges: amid the edge at which they meet, as in the paper's figures."""
