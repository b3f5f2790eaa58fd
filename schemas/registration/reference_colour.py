"""The colours of the reference mesh, with which those of all frames are compared (ours)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact
from kinetree.schemas.dims import RGB, VERTEX


class ReferenceColour(Artifact):
    """Colours of the reference mesh's vertices; no rows where it has none, or nothing is fitted."""

    colour: Annotated[NDArray[np.uint8], Array("uint8", VERTEX, RGB)]
    """sRGB, 0 to 255."""

    @classmethod
    def none(cls) -> "ReferenceColour":
        """Those of a body without colours."""
        return cls(colour=np.empty((0, 3), np.uint8))
