"""Names of joints as the skeleton has them, for tests of files."""

import numpy as np

from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton


def plain(skeleton: Skeleton, **changes: object) -> JointNames:
    """Nothing recognised; `changes` replace fields."""
    fields = {
        "given": skeleton.names, "names": skeleton.names, "anatomy": ("",) * len(skeleton.names), "topology": "unknown",
        "confidence": 0.0, "front": np.zeros(3), "front_confidence": 0.0,
    }  # fmt: skip
    return JointNames.model_validate({**fields, **changes})
