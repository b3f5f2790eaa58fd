"""What people see of the input."""

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.input.connectivity import Connectivity, Odd


@remarks_of(Connectivity)
def connectivity_remarks(connectivity: Connectivity) -> tuple[str, ...]:
    """Said where vertices are tracked already, which spares work, and where a few frames stand in the way of that."""
    if connectivity.fixed:
        return (f"fixed connectivity: the same {connectivity.faces} faces in every frame",)
    if not connectivity.odd:
        return ()
    first, others = connectivity.odd[0], len(connectivity.odd) - 1
    more = f" (and {others} other frame{'s' * (others > 1)})" if others else ""
    odd = f"most frames share one connectivity, but frame {first.frame}{more} does not: {_why(first)}"
    return (f"{odd}; so every frame is aligned as if it were surfaced by itself",)


def _why(odd: Odd) -> str:
    """What differs, in words."""
    if odd.inputs:
        return f"its file has {_counted(odd.inputs, 'vertex', 'vertices')}"
    if odd.welded > 0:
        which = "1 vertex lies on another and was" if odd.welded == 1 else f"{odd.welded} vertices lie on others and were"
        return f"{which} welded there (mesh.merge)"
    if odd.vertices or odd.faces:
        faces = _counted(odd.faces, "face", "faces")
        return f"after cleaning it has {_counted(odd.vertices, 'vertex', 'vertices')} and {faces}"
    return "its faces are others, or in another order"


def _counted(count: int, one: str, many: str) -> str:
    """A difference in words: 1 vertex more, 3 faces fewer."""
    return f"{abs(count)} {one if abs(count) == 1 else many} {'more' if count >= 0 else 'fewer'}"
