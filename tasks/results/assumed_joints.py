"""Joints that a recognised body has and that were not found."""

from collections.abc import Sequence

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.results.assumed_joints import AssumedJoint, AssumedJoints, AssumedJointsParams
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results import assumed_joints as numerics
from kinetree.tasks.numerics.results.limb_sections import section_middle, way_along
from kinetree.tasks.numerics.structure.name_styles import names_beside


@task()
def assumed_joints(skeleton: Skeleton, joint_names: JointNames, params: AssumedJointsParams) -> AssumedJoints:
    """Offers joints of people and four-legged animals that were not found, by symmetry or published proportions (ours)."""
    if not params.add:
        return AssumedJoints()
    assumed = numerics.assumed_joints(np.array(skeleton.rest), skeleton.parents, joint_names.anatomy, joint_names.topology)
    spelling = joint_names.spelling
    places = _places(skeleton, assumed)
    named = [joint.named for joint in assumed]
    names = names_beside(named, joint_names.names, spelling.style, spelling.side_suffixes, spelling.rename)
    return AssumedJoints(
        joints=tuple(
            AssumedJoint(
                name=name,
                anatomy=joint.named.text,
                child=joint.child,
                share=joint.share,
                place=(float(x), float(y), float(z)),
                source=joint.source,
            )
            for name, joint, (x, y, z) in zip(names, assumed, places, strict=True)
        )
    )


def _places(skeleton: Skeleton, assumed: Sequence[numerics.Assumed]) -> list[Floats]:
    """Where assumed joints lie in the reference pose: inside a limb in its middle, else on the straight bone."""
    V, F, rest = np.array(skeleton.vertices), np.array(skeleton.faces, np.int64), np.array(skeleton.rest)
    part = np.array(skeleton.influence, np.int64)[:, 0]
    places: list[Floats] = []
    for joint in assumed:
        straight = (1.0 - joint.share) * rest[skeleton.parents[joint.child]] + joint.share * rest[joint.child]
        middle = None
        if joint.named.station in numerics.ASSUMED:
            middle = section_middle(V, F, way_along(V, F, part, skeleton.parents, rest, joint.child), joint.share)
        places.append(straight if middle is None else middle)
    return places
