"""The articulated body with its poses as they are left: those of the aligned vertices, or of the fit where it was better."""

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.pose_refinement import PoseRefinement
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.structure.joint_rotations import turning_range


@task()
def skeleton(articulation: KinematicTree, fit: tuple[PoseRefinement, ...]) -> Skeleton:
    """Puts the fitted poses in their places; bones have one length in all of them (2014, Sec. 6.3)."""
    told = {name: getattr(articulation, name) for name in Skeleton.model_fields}
    if any(run.moved.any() for run in fit):
        for name in ("positions", "rotation", "confidence"):
            told[name] = _placed(told[name], articulation.frames, fit, name)
        told["degrees"] = _degrees(articulation, told["rotation"])
    return Skeleton(**told)


def _placed(
    before: NDArray[np.float64], frames: tuple[int, ...], fit: tuple[PoseRefinement, ...], name: str
) -> NDArray[np.float64]:
    after = np.array(before)
    for run in fit:
        after[[frames.index(frame) for frame in run.frames]] = getattr(run, name)
    return after


def _degrees(articulation: KinematicTree, rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """(joint,) range of the turning of each joint against its parent."""
    told = [
        turning_range(np.einsum("txy,txz->tyz", rotation[:, p], rotation[:, j])) if kind == "joint" else 0.0
        for j, (p, kind) in enumerate(zip(articulation.parents, articulation.kinds, strict=True))
    ]
    return np.array(told)
