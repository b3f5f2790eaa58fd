"""Which part every vertex of the input belongs to, and the reference mesh in every frame: segmentation.zarr."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Ints
from kinetree.schemas.dims import CORNER, FACE, FRAME, INPUT_VERTEX, VERTEX, XYZ


class Segmentation(Artifact):
    """Labels on the user's own vertices, frame after frame, and the aligned meshes.

    The labels of the i-th frame are label[begin[i]:end[i]], in the order of the vertices in that frame's file.
    """

    names: tuple[str, ...]
    """Name of every part, which is that of the joint it turns about."""
    unit: str | None
    """Unit of the aligned meshes; None where nobody knows."""
    error: float
    """Root mean square distance between the skinned mesh of the skeleton and the aligned meshes, mesh unit."""
    error_95: float
    """The distance that 95 % of vertices and frames stay below, mesh unit."""
    frame: Annotated[Ints, Array("int32", FRAME)]
    """Source frame number of every frame, ascending."""
    begin: Annotated[NDArray[np.int64], Array("int64", FRAME)]
    """Where the labels of each frame begin."""
    end: Annotated[NDArray[np.int64], Array("int64", FRAME)]
    """Where they end."""
    label: Annotated[Ints, Array("int32", INPUT_VERTEX)]
    """Part of every vertex of every frame's file, −1 where the surface is not rigid and where the vertex was dropped."""
    part: Annotated[Ints, Array("int32", VERTEX)]
    """Part of every vertex of the reference mesh, −1 where it is not rigid."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Faces of the reference mesh, the same in every frame."""
    aligned: Annotated[NDArray[np.float32], Array("float32", FRAME, VERTEX, XYZ, unit="length")]
    """The reference mesh in every frame."""
