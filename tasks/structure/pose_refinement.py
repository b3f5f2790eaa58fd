"""The finished body fitted to the surface of frames in which its pose is in doubt (2014, Sec. 7.3)."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.pose_refinement import PoseRefinement
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure import pose_refinement as numerics
from kinetree.tasks.numerics.structure.articulated_frame import Body, Posture, joints

Floats = NDArray[np.float64]
Longs = NDArray[np.int64]

SAMPLES = 3000
"""Vertices that stand for a frame's surface."""


@task(over="doubt")
def pose_refinement(
    articulation: KinematicTree, mesh: Mapping[int, Mesh], alignment: Mapping[int, Alignment]
) -> PoseRefinement:
    """Fits the finished body to the surface of each frame in doubt, and keeps what explains it better (2014, Sec. 7.3)."""
    turning, carrier = parts_of(articulation)
    body = body_of(articulation, turning)
    known = numerics.Known(articulation.rotation[:, turning], articulation.confidence[:, turning])
    rows = [articulation.frames.index(frame) for frame in mesh]
    kept = {name: np.array(getattr(articulation, name)[rows]) for name in ("positions", "rotation", "confidence")}
    moved, share = np.zeros(len(rows), np.bool_), np.zeros((2, len(rows)))
    for k, (row, seen, aligned) in enumerate(zip(rows, mesh.values(), alignment.values(), strict=True)):
        start = Posture(known.R[row].copy(), articulation.positions[row, 0].copy())
        target = Target.of(np.array(seen.vertices), seen.faces, body.size, SAMPLES)
        found = numerics.refined_pose(body, start, target, np.array(aligned.vertices), np.array(aligned.trust), known, row)
        moved[k], share[:, k] = found.moved, (found.before, found.after)
        if found.moved:
            told = carried(articulation, carrier, found.at.R, joints(body, found.at))
            kept["positions"][k], kept["rotation"][k], kept["confidence"][k] = *told, found.confidence[carrier]
    return PoseRefinement(frames=tuple(mesh), moved=moved, before=share[0], after=share[1], **kept)


def parts_of(skeleton: Skeleton) -> tuple[Longs, Longs]:
    """(part,) joints that carry a part, and (joint,) the part that each joint turns with."""
    turning = np.flatnonzero([kind != "leaf" for kind in skeleton.kinds])
    own = np.searchsorted(turning, [p if kind == "leaf" else j for j, (p, kind) in enumerate(_joints(skeleton))])
    return turning, own


def body_of(skeleton: Skeleton, turning: Longs) -> Body:
    """The body at rest; its parts are the joints that turn."""
    above = np.array(skeleton.parents)[turning]
    parents = np.where(above >= 0, np.searchsorted(turning, above), -1)
    bound = np.where(skeleton.weight > 0, np.searchsorted(turning, skeleton.influence), 0)
    return Body.of(skeleton.vertices, skeleton.faces, bound, skeleton.weight, skeleton.rest[turning], parents)


def carried(skeleton: Skeleton, carrier: Longs, R: Floats, X: Floats) -> tuple[Floats, Floats]:
    """(joint, xyz) and (joint, 3, 3) of all joints, the ends of bones with their parents, from those of the parts."""
    at, turn = X[carrier].copy(), R[carrier]
    for j, (p, kind) in enumerate(_joints(skeleton)):
        if kind == "leaf":
            at[j] = at[p] + turn[j] @ (skeleton.rest[j] - skeleton.rest[p])
    return at, turn


def _joints(skeleton: Skeleton) -> list[tuple[int, str]]:
    """Parent and kind of every joint."""
    return list(zip(skeleton.parents, skeleton.kinds, strict=True))
