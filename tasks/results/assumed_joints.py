"""Joints that a recognised body has and that were not found."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.results.assumed_joints import AssumedJoint, AssumedJoints, AssumedJointsParams
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results import assumed_joints as numerics
from kinetree.tasks.numerics.structure.name_styles import names_beside


@task()
def assumed_joints(skeleton: Skeleton, joint_names: JointNames, params: AssumedJointsParams) -> AssumedJoints:
    """Offers joints of people and four-legged animals that were not found, by symmetry or published proportions (ours)."""
    if not params.add:
        return AssumedJoints()
    found = numerics.assumed_joints(np.array(skeleton.rest), skeleton.parents, joint_names.anatomy, joint_names.topology)
    spelling = joint_names.spelling
    named = [joint.named for joint in found]
    names = names_beside(named, joint_names.names, spelling.style, spelling.side_suffixes, spelling.rename)
    return AssumedJoints(
        joints=tuple(
            AssumedJoint(name=name, anatomy=joint.named.text, child=joint.child, share=joint.share, source=joint.source)
            for name, joint in zip(names, found, strict=True)
        )
    )
