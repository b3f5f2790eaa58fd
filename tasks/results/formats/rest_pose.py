"""The body with another rest pose: T or A (ours)."""

from collections.abc import Mapping

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.results.glb import RestChoice
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results.evaluation.body import blended_skin
from kinetree.tasks.numerics.results.placement import upright_rotation
from kinetree.tasks.numerics.results.rest_pose import rest_pose, standing_targets
from kinetree.tasks.results.formats.rig import main_children

ARM_ANGLES: Mapping[str, float] = {"t": 0.0, "a": 45.0}
"""Degrees by which the arms hang below the horizontal in each pose."""


def at_rest(skeleton: Skeleton, names: JointNames, up: str, rest: RestChoice) -> tuple[Skeleton, RestChoice]:
    """The same motion from another rest pose, and the pose that it is: only a person has a T-pose or an A-pose.

    The mesh takes the new pose by its own skinning weights. So a vertex that follows several joints is not carried quite as
    from the reference pose; joints are.

    up : axis that points up
    """
    if rest == "reference" or names.topology != "human":
        return skeleton, "reference"
    s, upwards = skeleton, upright_rotation(up).T @ np.array([0.0, 1.0, 0.0])
    target = standing_targets(names.anatomy, upwards, np.array(names.front), ARM_ANGLES[rest])
    root = _upright_trunk(s, names, upwards)
    pose = rest_pose(np.array(s.rest), s.parents, main_children(s.rest, s.parents), root, target)
    changed = {
        "rest": pose.X,
        "vertices": blended_skin(s.vertices, s.influence, s.weight, s.rest, pose.R, pose.X),
        "rotation": s.rotation @ pose.R.transpose(0, 2, 1),
    }
    return s.model_copy(update=changed), rest


def _upright_trunk(skeleton: Skeleton, names: JointNames, up: Floats) -> Floats:
    """Rotation of the root that brings the line from hips to shoulders upright and the body's left to its left."""
    at = {name: skeleton.rest[j] for j, name in enumerate(names.anatomy)}
    places = [at.get(f"{name}_{side}") for name in ("hip", "shoulder") for side in "lr"]
    hips, shoulders = [p for p in places[:2] if p is not None], [p for p in places[2:] if p is not None]
    if len(hips) < 2 or len(shoulders) < 2:
        return np.eye(3)
    trunk, across = sum(shoulders) - sum(hips), hips[0] - hips[1]
    return _axes(up, np.cross(up, names.front)) @ _axes(trunk, across).T


def _axes(main: Floats, side: Floats) -> Floats:
    """Orthonormal axes by columns: along one vector, and towards another across it."""
    a = main / np.linalg.norm(main)
    b = side - (side @ a) * a
    b /= np.linalg.norm(b)
    return np.stack([a, b, np.cross(a, b)], axis=1)
