"""What colour every vertex of one frame has, where its file says (ours)."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Params
from kinetree.schemas.dims import RGB, VERTEX


class VertexColourParams(Params):
    """Whether colours are looked at."""

    use: Literal["auto", "never"] = "auto"
    """auto: colours and textures of the frames hold the alignment where they agree between frames; never: they are not read."""


class VertexColour(Artifact):
    """Colours of the cleaned mesh's vertices; no rows where the file has none, or they cannot be read."""

    colour: Annotated[NDArray[np.uint8], Array("uint8", VERTEX, RGB)]
    """sRGB, 0 to 255."""

    @classmethod
    def none(cls) -> "VertexColour":
        """Those of a frame without colours."""
        return cls(colour=np.empty((0, 3), np.uint8))
