"""Whether all frames share one connectivity, so that correspondence comes with the input."""

from collections import Counter
from collections.abc import Mapping

from kinetree.pipeline.task import task
from kinetree.schemas.input.connectivity import Connectivity, Odd
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence


@task(among=Sequence)
def connectivity(mesh: Mapping[int, Mesh]) -> Connectivity:
    """Recognises a sequence whose vertices are tracked already, and the frames that keep it from being one (2014, Sec. 7)."""
    first = next(iter(mesh.values()))
    # the same faces, and the same input vertices behind the same vertices
    kind = {t: (m.faces.tobytes(), m.vertex_of_input.tobytes()) for t, m in mesh.items()}
    usual, shared = Counter(kind.values()).most_common(1)[0]
    typical = mesh[next(t for t, own in kind.items() if own == usual)]
    odd = [t for t, own in kind.items() if own != usual] if 2 * shared > len(mesh) and shared > 1 else []
    return Connectivity(
        fixed=shared == len(mesh) > 1,
        first_change=next((t for t, own in kind.items() if own != kind[next(iter(mesh))]), None),
        vertices=len(first.vertices),
        faces=len(first.faces),
        odd=tuple(_difference(t, mesh[t], typical) for t in odd),
    )


def _difference(frame: int, other: Mesh, typical: Mesh) -> Odd:
    """By how much a frame differs from those that share one connectivity."""
    return Odd(
        frame=frame,
        inputs=len(other.vertex_of_input) - len(typical.vertex_of_input),
        welded=other.cleaning.merged - typical.cleaning.merged,
        vertices=len(other.vertices) - len(typical.vertices),
        faces=len(other.faces) - len(typical.faces),
    )
