"""Pictures for the report, rendered; every task that draws some leaves them in this form."""

import itertools
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Params
from kinetree.schemas.dims import BYTE, PICTURE


class Picture(Params):
    """One picture."""

    caption: str
    """What it shows."""
    alternative: str
    """What it shows of this run, for those who do not see it."""


class Figures(Artifact):
    """Pictures and their files."""

    pictures: tuple[Picture, ...]
    """The pictures, in order."""
    end: Annotated[NDArray[np.int64], Array("int64", PICTURE)]
    """Position in `content` at which each picture ends."""
    content: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The files of all pictures, one after another."""

    def files(self) -> tuple[bytes, ...]:
        """The file of each picture."""
        begin = [0, *self.end.tolist()]
        return tuple(self.content[a:b].tobytes() for a, b in itertools.pairwise(begin))
