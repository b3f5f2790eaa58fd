"""What the joints were found from, kept for figures."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.structure.traces import Traces, TracesParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.geometry.normals import vertex_areas
from kinetree.tasks.numerics.structure import traces as found
from kinetree.tasks.numerics.structure.frame_poses import seen_share
from kinetree.tasks.numerics.structure.part_tree import Carried, Surfaces
from kinetree.tasks.numerics.structure.rigid_parts import RigidPartsSettings
from kinetree.tasks.structure.rigid_parts import tips_of, trust_of

Floats = NDArray[np.float64]
Longs = NDArray[np.int64]


@task()
def traces(
    reference: Reference,
    alignment: Mapping[int, Alignment],
    leaves: Leaves,
    parts: RigidParts,
    skeleton: Skeleton,
    params: TracesParams,
) -> Traces:
    """Follows the structure once more and keeps what it was decided by (2014, Figs. 7, 11 and 15); decides nothing."""
    aligned = list(alignment.values())
    trust, tips, cut = trust_of(aligned), tips_of(leaves, reference), RigidPartsSettings().cut
    V, F, x = np.array(reference.vertices), np.array(reference.faces, np.int64), np.stack([a.vertices for a in aligned])
    body = Surfaces(V, F, x, vertex_areas(V, F))
    cones = found.traced_cones(V, F, x, trust, tips, params.rings, cut)
    carried = _carried(parts, body, trust)
    graph = found.parts_graph(body, carried)
    joint = _survivors(body, carried, skeleton)
    part = np.full(len(skeleton.names), -1)
    part[joint[joint >= 0]] = np.flatnonzero(joint >= 0)
    length = found.bone_lengths(skeleton.rest, np.array(skeleton.parents), part, carried.R, carried.t)
    follows = np.asarray(skeleton.influence[:, 0], np.int64)
    count = carried.R.shape[1]
    mass = np.bincount(carried.label, body.area, count)
    return Traces(
        threshold=cut,
        tips=tips,
        **cones._asdict(),
        joint_of_annulus=found.most(cones.own, follows, body.area, params.rings),
        **graph._asdict(),
        middle=np.stack([np.bincount(carried.label, body.area * V[:, k], count) / mass for k in range(3)], axis=1),
        joint=joint,
        length=length.mean(axis=0),
        deviation=length.std(axis=0),
    )


def _carried(parts: RigidParts, body: Surfaces, trust: Floats | None) -> Carried:
    """The parts that have vertices."""
    used, label = np.unique(parts.label, return_inverse=True)
    R, t, residual = (np.array(a[:, used]) for a in (parts.rotation, parts.translation, parts.residual))
    seen = None if trust is None else seen_share(label, body.area, trust, len(body.x), len(used))
    return Carried(label.astype(np.int64), R, t, residual, seen)


def _survivors(body: Surfaces, carried: Carried, skeleton: Skeleton) -> Longs:
    """(part,) joint of the skeleton that carries each part, −1 for none."""
    joints = np.array([j for j, kind in enumerate(skeleton.kinds) if kind != "leaf"], np.int64)
    R = skeleton.rotation[:, joints]
    t = skeleton.positions[:, joints] - np.einsum("tjxy,jy->tjx", R, skeleton.rest[joints])
    return found.survivors(body.V, body.area, carried, joints, R, t)
