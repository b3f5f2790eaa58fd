"""One frame's surface, loaded and cleaned."""

import math

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.isosurface import Isosurface
from kinetree.schemas.input.mesh import Cleaning, Mesh, MeshParams
from kinetree.schemas.input.source import Source
from kinetree.tasks.input.frames.read import name, surface
from kinetree.tasks.numerics.input.mesh import Cleaned, clean


@task(over="frame")
def mesh(source: Source, params: MeshParams, isosurface: tuple[Isosurface, ...] = ()) -> Mesh:
    """Loads one frame and cleans it: welded, oriented, without debris, with the way back to the file (2014, Sec. 3).

    isosurface : of silhouettes or a volume, whose vertices then are the input's; none where the frame is a mesh
    """
    V, F = (np.array(isosurface[0].vertices), np.array(isosurface[0].faces)) if isosurface else surface(source)
    cleaned = clean(V, F, merge=params.merge, component_share=params.component_share, name=name(source))
    return Mesh(vertices=cleaned.V, faces=cleaned.F, vertex_of_input=cleaned.vertex_map, cleaning=_cleaning(cleaned))


def _cleaning(cleaned: Cleaned) -> Cleaning:
    """What cleaning did, without the arrays."""
    return Cleaning(
        merged=cleaned.merged,
        unreferenced=cleaned.unreferenced,
        degenerate=cleaned.degenerate,
        duplicate=cleaned.duplicate,
        needles=cleaned.needles,
        flipped=cleaned.flipped,
        components=len(cleaned.is_body),
        components_kept=int(cleaned.is_body.sum()),
        share_kept=float(cleaned.shares[cleaned.is_body].sum()),
        nested=cleaned.nested,
        boundary_edges=cleaned.boundary_edges,
        non_manifold_edges=cleaned.non_manifold_edges,
        disagreeing_edges=cleaned.disagreeing_edges,
        euler=cleaned.euler,
        area=cleaned.area,
        volume=None if math.isnan(cleaned.volume) else cleaned.volume,
    )
