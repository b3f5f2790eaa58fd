"""Exports the rig in RigNet's text format, for learning programs."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.rignet import Rignet
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.placement import renamed
from kinetree.tasks.results.formats.rignet import rignet as rignet_files


@task(on_request=True)
def rignet(skeleton: Skeleton, joint_names: JointNames) -> Rignet:
    """Writes the rig as RigNet's text, with the mesh it belongs to (ours)."""
    return Rignet.of({f"rignet/{name}": data for name, data in rignet_files(renamed(skeleton, joint_names)).items()})
