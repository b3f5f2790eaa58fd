"""What the player shows of a result besides its motion: the skinned mesh and how far each part of it can be relied on."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.arrays import Ints
from kinetree.tasks.results.page.scene import Scene


class Trust(NamedTuple):
    """What a player shows of a result besides its motion.

    labels : (joint,) what people call the joints
    error  : by source frame number, (vertex,) distance of the skinned mesh to the input, mesh unit
    most   : the distance that has the last colour, mesh unit
    share  : the same, share of the diagonal of the body's box
    state  : (frame, joint) 0 trusted, 1 uncertain, 2 wrong
    bound  : (frame, joint) distance from the true joint that nine joints of ten keep, mesh unit, NaN where it is not known;
             None where no error is known
    """

    labels: tuple[str, ...]
    error: Mapping[int, NDArray[np.floating]]
    most: float
    share: float
    state: NDArray[np.integer]
    bound: Floats | None = None


def with_trust(scene: Scene, skeleton: Skeleton, trust: Trust) -> Scene:
    """The scene with the skinned mesh, its error and the confidence of joints, which people's words call what they are."""
    frames = np.array([skeleton.frames.index(frame) for frame in scene.description["frames"]])
    rig = _rig(skeleton, scene.reference_vertex, frames, scene.axes)
    packing = scene.packing.followed_by(rig | _trusted(skeleton, scene.reference_vertex, frames, trust))
    joints = [{**joint, "label": label} for joint, label in zip(scene.description["joints"], trust.labels, strict=True)]
    changed = {"joints": joints, "most": trust.share, "arrays": packing.layout}
    return scene._replace(description={**scene.description, **changed}, packing=packing)


def _rig(skeleton: Skeleton, selected: Ints, frames: Ints, axes: Floats) -> dict[str, NDArray[Any]]:
    """The skinned mesh as the player poses it: selected vertices with their weights, and the rotations of all joints."""
    turns = axes.T @ np.asarray(skeleton.rotation)[frames] @ axes
    shape = turns.shape[:2]
    return {
        "rest_vertices": (np.asarray(skeleton.vertices)[selected] @ axes).astype(np.float32),
        "rest": (np.asarray(skeleton.rest) @ axes).astype(np.float32),
        "influence": np.asarray(skeleton.influence)[selected].astype(np.uint16),
        "weight": np.asarray(skeleton.weight)[selected].astype(np.float32),
        "turns": Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_quat().reshape(*shape, 4).astype(np.float32),
    }


def _trusted(skeleton: Skeleton, selected: Ints, frames: Ints, trust: Trust) -> dict[str, NDArray[Any]]:
    """Error, confidence and state as bytes; bounds where errors are known, 0 for joints without one."""
    error = np.stack([trust.error[skeleton.frames[t]][selected] for t in frames]) / max(trust.most, 1e-300)
    bound = {} if trust.bound is None else {"bound": np.nan_to_num(trust.bound[frames], nan=0.0).astype(np.float32)}
    return {
        "error": np.rint(255 * np.clip(error, 0.0, 1.0)).astype(np.uint8),
        "confidence": np.rint(255 * np.clip(np.asarray(skeleton.confidence)[frames], 0.0, 1.0)).astype(np.uint8),
        "state": np.asarray(trust.state)[frames].astype(np.uint8),
        **bound,
    }
