"""How far the skinned mesh and the input mesh are from each other in one frame (ours)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import JOINT, VERTEX


class SurfaceError(Artifact):
    """What is exported against what was put in, frame by frame: the skinned mesh and the joints against the input mesh."""

    distance: Annotated[NDArray[np.float32], Array("float32", VERTEX, unit="length")]
    """Of every vertex of the skinned mesh to the input mesh."""
    skin: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Root mean square of these over the vertices of each joint's part; 0 for a joint without a part."""
    surface: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Root mean square distance of the input's vertices to the skinned mesh, by the part nearest to them; 0 where none is."""
    outside: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """How far each joint lies outside the input mesh; 0 inside."""
