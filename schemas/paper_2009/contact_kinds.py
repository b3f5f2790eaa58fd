"""How branches of the body touch, frame by frame (2009, Sec. 2.6)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact
from kinetree.schemas.dims import CONTACT

Longs = NDArray[np.int64]


class ContactKinds(Artifact):
    """Pairs of branches that touch."""

    frame: Annotated[Longs, Array("int64", CONTACT)]
    """Source frame number."""
    branch: Annotated[Longs, Array("int64", CONTACT)]
    """The first branch: leaf of the integrated structure, −1 for the trunk."""
    other: Annotated[Longs, Array("int64", CONTACT)]
    """The second branch."""
    kind: Annotated[Longs, Array("int64", CONTACT)]
    """1: end to end; 2: end to side; 3: side to side, which the paper excludes where the place of contact changes."""
