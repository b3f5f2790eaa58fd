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

    def why(self) -> str:
        """What differs, in words."""
        if self.inputs:
            return f"its file has {_counted(self.inputs, 'vertex', 'vertices')}"
        if self.welded > 0:
            which = "1 vertex lies on another and was" if self.welded == 1 else f"{self.welded} vertices lie on others and were"
            return f"{which} welded there (mesh.merge)"
        if self.vertices or self.faces:
            faces = _counted(self.faces, "face", "faces")
            return f"after cleaning it has {_counted(self.vertices, 'vertex', 'vertices')} and {faces}"
        return "its faces are others, or in another order"


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
    """Frames that differ where more than half share one connectivity: but for them it would be fixed."""

    def remarks(self) -> tuple[str, ...]:
        """Said where vertices are tracked already, which spares work, and where a few frames stand in the way of that."""
        if self.fixed:
            return (f"fixed connectivity: the same {self.faces} faces in every frame",)
        if not self.odd:
            return ()
        first, others = self.odd[0], len(self.odd) - 1
        more = f" (and {others} other frame{'s' * (others > 1)})" if others else ""
        odd = f"most frames share one connectivity, but frame {first.frame}{more} does not: {first.why()}"
        return (f"{odd}; so every frame is aligned as if it were surfaced by itself",)


def _counted(count: int, one: str, many: str) -> str:
    """A difference in words: 1 vertex more, 3 faces fewer."""
    return f"{abs(count)} {one if abs(count) == 1 else many} {'more' if count >= 0 else 'fewer'}"
