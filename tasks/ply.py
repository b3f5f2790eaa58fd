"""The user's own meshes with their parts."""

from kinetree.pipeline.errors import MeshError
from kinetree.pipeline.task import task
from kinetree.schemas.ply import Ply
from kinetree.schemas.projection import Projection
from kinetree.schemas.skeleton import Skeleton
from kinetree.schemas.source import Source
from kinetree.tasks.exports.labels import input_labels
from kinetree.tasks.exports.ply import ply as written
from kinetree.tasks.source import name, surface


@task(over="frame", on_request=True)
def ply(source: Source, projection: Projection, skeleton: Skeleton) -> Ply:
    """Writes one frame's own mesh with its vertices coloured and numbered by part (ours)."""
    V, F = surface(source)
    if len(V) != len(projection.face):
        raise MeshError(f"{name(source)}: it has {len(V)} vertices, but {len(projection.face)} were aligned; run again")
    return Ply.of({"frame.ply": written(V, F, input_labels(skeleton, projection), skeleton)})
