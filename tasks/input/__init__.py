"""Step 0, what is captured: frames, volumes and meshes, whether all share one connectivity (2014, Sec. 3; 2009, Sec. 2)."""

from kinetree.tasks.input.connectivity import connectivity
from kinetree.tasks.input.hull import hull
from kinetree.tasks.input.isosurface import isosurface
from kinetree.tasks.input.mesh import mesh
from kinetree.tasks.input.sequence import sequence
from kinetree.tasks.input.source import source

INPUT = (
    source,
    sequence,
    hull,
    isosurface,
    mesh,
    connectivity,
)
