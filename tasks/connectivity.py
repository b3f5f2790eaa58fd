"""Whether all frames share one connectivity, so that correspondence comes with the input."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.connectivity import Connectivity
from kinetree.schemas.mesh import Mesh


@task()
def connectivity(mesh: Mapping[int, Mesh]) -> Connectivity:
    """Recognises a sequence whose vertices are tracked already (2014, Sec. 7)."""
    first = next(iter(mesh.values()))
    changed = (t for t, m in mesh.items() if not _same(first, m))
    change = next(changed, None)
    return Connectivity(
        fixed=change is None and len(mesh) > 1,
        first_change=change,
        vertices=len(first.vertices),
        faces=len(first.faces),
    )


def _same(a: Mesh, b: Mesh) -> bool:
    """Same faces, and the same input vertices behind the same vertices."""
    return np.array_equal(a.faces, b.faces) and np.array_equal(a.vertex_of_input, b.vertex_of_input)
