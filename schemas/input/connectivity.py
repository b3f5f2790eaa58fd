"""Whether all frames share one connectivity (2014, Sec. 7: such sequences need no Steps I and II)."""

from kinetree.schemas.array import Artifact, Params


class Odd(Params):
    """A frame whose connectivity is not that of most frames, and by how much it differs."""

    frame: int
    """Its source frame number."""
    inputs: int
    """Vertices of the user's file beyond those of the others."""
    welded: int
    """Vertices that cleaning welded beyond those of the others."""
    vertices: int
    """Vertices after cleaning beyond those of the others."""
    faces: int
    """Faces after cleaning beyond those of the others."""


class Connectivity(Artifact):
    """Whether vertex v is the same point of the body in every frame."""

    fixed: bool
    """True where every frame has the same faces over the same number of vertices."""
    first_change: int | None
    """Source frame number of the first frame whose faces differ from those of the first; None where none does."""
    vertices: int
    """Vertices of the first frame."""
    faces: int
    """Faces of the first frame."""
    odd: tuple[Odd, ...] = ()
    """The frames without which the connectivity would be fixed, where more than half share one."""
