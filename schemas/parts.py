"""The rigid parts of the body and the rest of its surface (2014, Sec. 6.1 and 6.2)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import FRAME, PART, ROW, VERTEX, XYZ


class Parts(Artifact):
    """Which vertex of the reference mesh belongs to which rigid part, and how the parts move."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """Part of every vertex of the reference mesh, that moves most like it; no vertex is without one."""
    rigid: Annotated[Floats, Array("float64", VERTEX)]
    """Share of each vertex's motion that its part alone explains: 1 on bones, less where the surface blends."""
    rotation: Annotated[Floats, Array("float64", FRAME, PART, ROW, XYZ)]
    """Of every part from the reference mesh to each frame."""
    translation: Annotated[Floats, Array("float64", FRAME, PART, XYZ, unit="length")]
    """x(t) = rotation · v + translation for a vertex v of the reference mesh."""
    residual: Annotated[Floats, Array("float64", FRAME, PART, unit="length")]
    """Root mean square of what the part's motion leaves of its clearly rigid vertices' motion."""
