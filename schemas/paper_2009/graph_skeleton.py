"""How clusters become the joints of a skeleton (2009, Sec. 2.4)."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.structure.kinematic_tree import JointParams


class GraphSkeletonParams(JointParams):
    """Where joints are, and what counts as one where they are rotation centres."""

    joints: Literal["centres", "edges"] = "centres"
    """centres: where two clusters turn about each other; edges: amid the edge at which they meet, as in the paper's figures."""
    removal_cost: float = Field(default=0.0025, gt=0)
    """Motion of the aligned surface left unexplained without a cluster, where joints are rotation centres; share of the root of
    the area."""
    second_ends: bool = True
    """Whether the last part of a limb also ends where it stands out beside its tip, as a foot does at the heel; not used where
    joints are edges."""
    root: Literal["limbs", "surface"] = "limbs"
    """limbs: the root lies amid the joints of the limbs that hang on it, if the body goes on in a trunk beside them; surface:
    amid its own surface. Not used where joints are edges."""
