"""How a skeleton was derived: reference, rigid parts and a kinematic tree that fit a known skeleton."""

import numpy as np

from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import ArticulatedBody, Skeleton

RINGS = 6


def reference_of(skeleton: Skeleton) -> Reference:
    """The mesh that the skeleton's surface is, from its first frame."""
    return Reference(
        frames=skeleton.frames, frame=skeleton.frames[0], vertices=skeleton.vertices, faces=skeleton.faces, size=1.0,
        fixed=True, leaves=0, free=True, stems=np.zeros((0, 4, 3)), score=np.zeros(len(skeleton.frames)),
    )  # fmt: skip


def parts_of(skeleton: Skeleton) -> RigidParts:
    """Cones of four annuli around the ends of bones; a part for every joint that is none, and one of no motion of its own."""
    V, rest = skeleton.vertices, skeleton.rest
    leaves = [j for j, kind in enumerate(skeleton.kinds) if kind == "leaf"]
    carriers = [j for j, kind in enumerate(skeleton.kinds) if kind != "leaf"]
    away = np.linalg.norm(V - rest[leaves][:, None], axis=2)
    ring = (away / (0.05 * np.ptp(V))).astype(np.int32)
    cone = np.where(ring.min(axis=0) < 4, away.argmin(axis=0), -1)
    within = np.arange(RINGS) < 4
    count = len(carriers) + 1
    label = np.searchsorted(carriers, np.where(np.isin(skeleton.label, carriers), skeleton.label, carriers[0]))
    label[np.argmax(away.min(axis=0))] = count - 1
    frames = len(skeleton.frames)
    return RigidParts(
        frames=skeleton.frames, label=label, rigid=np.ones(len(V)), rotation=np.tile(np.eye(3), (frames, count, 1, 1)),
        translation=np.zeros((frames, count, 3)), residual=np.zeros((frames, count)), tip=away.argmin(axis=1), cone=cone,
        ring=np.where(cone >= 0, ring.min(axis=0), -1),
        run=np.tile(np.where(within, np.arange(RINGS) // 2, -1), (len(leaves), 1)),
        merge=np.tile(np.where(np.arange(RINGS) < 3, 0.001 * np.arange(1, RINGS + 1), np.nan), (len(leaves), 1)),
        merge_threshold=0.002, initial=label, removed=np.array([count, count + 1]), cost=np.array([0.0, 0.001]),
        cost_threshold=0.0025, origin=np.arange(count),
    )  # fmt: skip


def tree_of(skeleton: Skeleton) -> KinematicTree:
    """The skeleton, the graph of its parts, of which the last was dropped, and lengths that vary by a hundredth."""
    parents = np.array(skeleton.parents)
    carriers = [j for j, kind in enumerate(skeleton.kinds) if kind != "leaf"]
    below = [k for k, j in enumerate(carriers) if parents[j] >= 0]
    count = len(carriers)
    pair = np.array([*([carriers.index(parents[carriers[k]]), k] for k in below), [0, count]], np.int32)
    fields = {name: getattr(skeleton, name) for name in ArticulatedBody.model_fields}
    return KinematicTree(
        **fields, uncertain=np.zeros(len(skeleton.frames), bool), part=parts_of(skeleton).label, pair=pair,
        centre=skeleton.rest[[*(carriers[k] for k in below), 0]], border_drift=np.full(len(pair), 0.01),
        border_degrees=np.full(len(pair), 20.0), joint_of_part=np.array([*carriers, -1]), dropped=((count, "sliding"),),
        free_length=skeleton.lengths, free_deviation=0.01 * skeleton.lengths,
        spread=np.full(len(parents), np.nan), agreeing=np.zeros(len(parents), int), joint_residual=np.zeros(len(parents)),
        surface_offset=np.full(len(parents), np.nan), hinge_offset=np.full(len(parents), np.nan),
        border_radius=np.full(len(parents), np.nan), partner=np.full(len(parents), -1),
    )  # fmt: skip
