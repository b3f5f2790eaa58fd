"""The colours of one frame's vertices."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.vertex_colour import VertexColour, VertexColourParams
from kinetree.tasks.input.frames.appearance import appearance_of, has_own_file
from kinetree.tasks.input.frames.read import painted
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.registration.vertex_colour import vertex_colours


@task(over="frame")
def vertex_colour(source: Source, mesh: Mesh, params: VertexColourParams) -> VertexColour:
    """Reads the colours of one frame, or what its texture has there, for the vertices of the cleaned mesh (ours).

    No run fails for a colour: what cannot be read is left out.
    """
    try:
        colour = None if params.use == "never" else _colours(source, mesh)
    except Exception:  # readers of other people's files raise anything
        colour = None
    if colour is None:
        return VertexColour.none()
    return VertexColour(colour=np.round(255.0 * colour).astype(np.uint8))


def _colours(source: Source, mesh: Mesh) -> Floats | None:
    """(vertex, rgb) sRGB from 0 to 1, or None."""
    vertex_map = mesh.vertex_of_input.astype(np.int64)
    if source.kind == "synth":
        colour = painted(source)
        if colour is None:
            return None
        out = np.zeros((len(mesh.vertices), 3))
        out[vertex_map[vertex_map >= 0]] = colour[vertex_map >= 0]
        return out
    found = appearance_of(source, quickly=True) if has_own_file(source) else None
    return None if found is None else vertex_colours(found, vertex_map, len(mesh.vertices))
