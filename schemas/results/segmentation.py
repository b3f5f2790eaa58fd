"""The part of every input vertex, and the reference mesh in every frame: segmentation.zarr."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Ints
from kinetree.schemas.dims import CORNER, FACE, FRAME, INPUT_VERTEX, JOINT, RGB, VERTEX, XYZ


class Segmentation(Artifact):
    """Part labels of the input's vertices in all frames, and the aligned meshes.

    The labels of the i-th frame are label[begin[i]:end[i]], in the order of the vertices of that frame's file.
    """

    names: tuple[str, ...]
    """Name of every part by its number: that of the joint about which it turns, as other files have it."""
    unit: str | None
    """Unit of the aligned meshes; None where it is not known."""
    error: float
    """Root mean square distance between the skinned mesh and the aligned meshes, mesh unit."""
    error_95: float
    """95 % quantile of that distance over all vertices and frames, mesh unit."""
    frame: Annotated[Ints, Array("int32", FRAME)]
    """Source frame number of every frame, ascending."""
    begin: Annotated[NDArray[np.int64], Array("int64", FRAME)]
    """Position of the first label of each frame."""
    end: Annotated[NDArray[np.int64], Array("int64", FRAME)]
    """Position after the last label of each frame."""
    label: Annotated[Ints, Array("int32", INPUT_VERTEX)]
    """Part of every vertex of every frame's file; −1 where the surface is not rigid, and where cleaning removed the vertex."""
    part: Annotated[Ints, Array("int32", VERTEX)]
    """Part of every vertex of the reference mesh, −1 where the surface is not rigid."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Faces of the reference mesh, the same in every frame."""
    colour: Annotated[NDArray[np.uint8], Array("uint8", JOINT, RGB)]
    """Colour of every part in all files, pictures and pages, sRGB."""
    aligned: Annotated[NDArray[np.float32], Array("float32", FRAME, VERTEX, XYZ, unit="length")]
    """The reference mesh in every frame."""
