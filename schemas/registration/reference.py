"""The one mesh that follows the body (2014, Sec. 5.3)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import CORNER, FACE, FRAME, LEAF, STATION, VERTEX, XYZ


class ReferenceParams(Params):
    """Which frame it is, where that is known."""

    frame: int | None = None
    """Source frame number of the reference; None chooses the best of the frames that the body is learned from."""


class Reference(Artifact):
    """The reference mesh, and from which frame it is."""

    frames: tuple[int, ...]
    """Source frame number of every frame among which it was chosen, ascending."""
    frame: int
    """Source frame number of the reference."""
    fixed: bool
    """Whether all frames have its connectivity, so that nothing is to be fitted."""
    leaves: int
    """Most limbs seen in any frame."""
    free: bool
    """Whether as many limbs are seen there, and in the frames around it, as anywhere."""
    loop: float = 0.0
    """How far the longest loop of its surface reaches, share of the range of μ; 0 without loops."""
    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """Its vertices, as its cleaned mesh has them."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Its faces."""
    size: float
    """Root of its area, length: what every length of the alignment is relative to."""
    stems: Annotated[Floats, Array("float64", LEAF, STATION, XYZ, unit="length")]
    """Centres of its limbs from their roots to their ends; none where they are not known."""
    score: Annotated[Floats, Array("float64", FRAME)]
    """How fit each frame is as the reference, at most 1, higher is better."""
