"""Step 0, what is captured: frames, volumes and meshes, whether all share one connectivity (2014, Sec. 3; 2009, Sec. 2).

The list of operations is made when it is asked for: to find frames, which every plan begins with, needs none of the others.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinetree.pipeline.task import Task

    INPUT: "tuple[Task[..., Any], ...]"


def __getattr__(name: str) -> Any:
    """Imports the operations when `INPUT` is asked for."""
    if name != "INPUT":
        raise AttributeError(f"{__name__} has no {name}")
    from kinetree.tasks.input.connectivity import connectivity
    from kinetree.tasks.input.hull import hull
    from kinetree.tasks.input.isosurface import isosurface
    from kinetree.tasks.input.mesh import mesh
    from kinetree.tasks.input.sequence import sequence
    from kinetree.tasks.input.source import source

    return (
        source,
        sequence,
        hull,
        isosurface,
        mesh,
        connectivity,
    )
