"""What the reference mesh looks like: texture coordinates, textures and colours of the file that it is from."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import BYTE, CORNER, FACE, RGB, SURFACE_VERTEX, UV


class SurfaceMaterial(Params):
    """The colour of some faces."""

    name: str
    """As the file calls it."""
    colour: tuple[float, float, float, float]
    """Linear r, g, b and a, 0 to 1."""
    picture: int | None
    """The picture that the colour is multiplied with."""


class Appearance(Artifact):
    """The reference mesh with one copy of a vertex for each of its texture coordinates and colours; empty where there are none.

    The seams of a textured file are welded in the reference mesh; here they are open, and faces are in its order.
    """

    frame: int | None
    """Source frame number of the file; None where the file has no appearance, or the reference mesh is of no file."""
    vertex: Annotated[Ints, Array("int32", SURFACE_VERTEX)]
    """The vertex of the reference mesh that each is a copy of, ascending."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Every face of the reference mesh by copies."""
    has_uv: bool
    """Whether there are texture coordinates."""
    uv: Annotated[Floats, Array("float64", SURFACE_VERTEX, UV)]
    """Texture coordinates from the picture's upper left."""
    has_colour: bool
    """Whether vertices have colours."""
    colour: Annotated[Floats, Array("float64", SURFACE_VERTEX, RGB)]
    """Linear, 0 to 1."""
    material: Annotated[Ints, Array("int32", FACE)]
    """Which of `materials`."""
    materials: tuple[SurfaceMaterial, ...]
    """Materials of the file."""
    media: tuple[str, ...]
    """Of every picture: image/png or image/jpeg."""
    sizes: tuple[int, ...]
    """Bytes of every picture."""
    content: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The bytes of all pictures, one after the other."""
    missing: tuple[str, ...]
    """Sentences on what the file names and could not be had."""

    @classmethod
    def none(cls, missing: tuple[str, ...] = ()) -> "Appearance":
        """That of a surface without one."""
        arrays = {name: np.empty([d.size or 0 for d in a.dims], a.dtype) for name, a in cls.array_fields().items()}
        return cls(frame=None, has_uv=False, has_colour=False, materials=(), media=(), sizes=(), missing=missing, **arrays)
