"""How a deformation graph is bent onto one frame: result of tracking and of every refit (2014, Sec. 5.3)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import NODE, ROW, XYZ


class Pose(Artifact):
    """x(v) = Σ_j w_vj [R_j (v − g_j) + p_j] over the nodes j that vertex v follows; empty for fixed connectivity."""

    rotation: Annotated[Floats, Array("float64", NODE, ROW, XYZ)]
    """R, rotation of every node from the reference to this frame."""
    translation: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """p, position of every node in this frame."""
