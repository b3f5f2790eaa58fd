"""Exports the rig in RigNet's text format, for learning programs."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.rignet import Rignet
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.rignet import rignet as rignet_files


@task(on_request=True)
def rignet(skeleton: Skeleton) -> Rignet:
    """Writes the rig as RigNet's text, with the mesh it belongs to (ours)."""
    return Rignet.of({f"rignet/{name}": data for name, data in rignet_files(skeleton).items()})
