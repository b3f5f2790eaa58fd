"""How a deformation graph is bent onto one frame: what tracking, repair and every refit leave (2014, Sec. 5.3)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import NODE, ROW, XYZ


class Pose(Artifact):
    """x(v) = Σ_j w_vj [R_j (v − g_j) + p_j] over the nodes j that vertex v follows; empty for fixed connectivity."""

    steps: int
    """Frames between the reference and this one, in the order in which frames are reached; 0 for the reference."""
    rotation: Annotated[Floats, Array("float64", NODE, ROW, XYZ)]
    """R, of every node from the reference to this frame."""
    translation: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """p, where every node is in this frame."""
