"""Step 0, what is captured: frames, their meshes, whether they share one connectivity (2014, Sec. 3 and 7)."""

from kinetree.tasks.input.connectivity import connectivity
from kinetree.tasks.input.mesh import mesh
from kinetree.tasks.input.sequence import sequence
from kinetree.tasks.input.source import source

INPUT = (
    source,
    sequence,
    mesh,
    connectivity,
)
