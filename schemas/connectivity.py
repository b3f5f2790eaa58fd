"""Whether all frames share one connectivity (2014, Sec. 7: such sequences need no Steps I and II)."""

from kinetree.schemas.array import Artifact


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

    def remarks(self) -> tuple[str, ...]:
        """Said where it spares work: vertices that are tracked already."""
        return (f"fixed connectivity: the same {self.faces} faces in every frame",) if self.fixed else ()
