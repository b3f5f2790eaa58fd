"""Exports the input meshes with their parts as PLY."""

import numpy as np

from kinetree.errors import MeshError
from kinetree.pipeline.task import task
from kinetree.schemas.input.isosurface import Isosurface
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.ply import Ply
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.input.frames.read import name, surface
from kinetree.tasks.results.formats.labels import input_labels
from kinetree.tasks.results.formats.placement import renamed
from kinetree.tasks.results.formats.ply import ply as ply_bytes


@task(over="frame", on_request=True)
def ply(
    source: Source, projection: Projection, skeleton: Skeleton, joint_names: JointNames, isosurface: tuple[Isosurface, ...] = ()
) -> Ply:
    """Writes the input mesh of one frame with its vertices coloured and numbered by part, and the names of parts (ours)."""
    V, F = (np.array(isosurface[0].vertices), np.array(isosurface[0].faces)) if isosurface else surface(source)
    if len(V) != len(projection.face):
        raise MeshError(
            f"{name(source)}: the file has {len(V)} vertices now, but had {len(projection.face)} when it was read; run again"
        )
    return Ply.of({"frame.ply": ply_bytes(V, F, input_labels(skeleton, projection), renamed(skeleton, joint_names))})
