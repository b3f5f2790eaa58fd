"""Names that people know for the joints of people and four-legged animals."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.structure.joint_names import JointNames, JointNamesParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.structure.anatomical_names import Named, anatomical_names
from kinetree.tasks.numerics.structure.anatomy import anatomy
from kinetree.tasks.numerics.structure.limb_motion import Motion
from kinetree.tasks.numerics.structure.name_styles import styled_names
from kinetree.tasks.structure.arguments.signed_axis import signed_axis


@task()
def joint_names(skeleton: Skeleton, up_direction: UpDirection, params: JointNamesParams) -> JointNames:
    """Recognises people and four-legged animals, and names their joints by place, side and front (ours)."""
    count = len(skeleton.names)
    body = Motion(
        np.array(skeleton.rest),
        np.array(skeleton.parents),
        np.array(skeleton.positions),
        np.array(skeleton.rotation),
        signed_axis(up_direction.up),
    )
    front = None if params.front is None else signed_axis(params.front)
    found = None if params.style == "none" else anatomy(body, front)
    ends = np.array([kind == "leaf" for kind in skeleton.kinds])
    named: list[Named | None] = [None] * count if found is None else anatomical_names(body, ends, found)
    style = "kinetree" if found is None or found.topology == "quadruped" else params.style
    return JointNames(
        given=skeleton.names,
        names=styled_names(named, skeleton.names, style, params.side_suffixes, params.rename),
        anatomy=tuple("" if name is None else name.text for name in named),
        topology="unknown" if found is None else found.topology,
        confidence=0.0 if found is None else found.confidence,
        front=np.zeros(3) if found is None else found.front,
        front_confidence=0.0 if found is None else found.certainty,
        spelling=params.model_copy(update={"style": style, "front": None}),
    )
