"""A body that is followed without error, as the tasks of the shelf `structure` read it."""

import numpy as np
from articulated import Known
from smeared import Frames, aligned, turning

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.agreed_tree import AgreedTree
from kinetree.schemas.structure.end_rings import EndRings
from kinetree.schemas.structure.extended_tree import ExtendedTree, ExtendedTreeParams
from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import AgreedTreeParams
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.structure.agreed_tree import agreed_tree
from kinetree.tasks.structure.end_rings import end_rings
from kinetree.tasks.structure.extended_tree import extended_tree

FIRST = 10


def rigid(body: Known, frames: tuple[int, ...]) -> RigidParts:
    """The true parts; how they were cut decides nothing."""
    none = np.zeros(len(body.V), int)
    return RigidParts(
        frames=frames, label=body.label, rigid=np.ones(len(body.V)), rotation=body.R, translation=body.t,
        residual=body.residual, tip=none[:0], cone=none - 1, ring=none - 1, run=np.zeros((0, 4), int), merge=np.zeros((0, 4)),
        merge_threshold=0.002, initial=body.label, removed=none[:0], cost=np.zeros(0), cost_threshold=0.0025,
        origin=np.arange(body.R.shape[1]),
    )  # fmt: skip


def task_inputs(V: np.ndarray, F: np.ndarray, x: np.ndarray) -> tuple[Reference, dict[int, Alignment], Leaves]:
    """What the task reads."""
    frames = tuple(range(FIRST, FIRST + len(x)))
    reference = Reference(
        frames=frames, frame=FIRST + 2, vertices=V, faces=F, size=1.0, fixed=True, leaves=0, free=True,
        stems=np.zeros((0, 4, 3)), score=np.zeros(len(x)),
    )  # fmt: skip
    zero, one = np.zeros(len(V)), np.ones(len(V))
    aligned = {
        f: Alignment(vertices=y, residual=zero, stretch=one, confidence=one, uncovered=0.0)
        for f, y in zip(frames, x, strict=True)
    }
    leaves = Leaves(
        frames=frames, rows=np.zeros((0, len(x)), int), positions=np.zeros((0, len(x), 3)), kept=np.ones((1, 0), bool),
        lost=np.zeros(0, int), lost_begin=np.zeros(0, int), lost_end=np.zeros(0, int),
    )  # fmt: skip
    return reference, aligned, leaves


def agreed(
    first: FirstTree,
    reference: Reference,
    alignment: dict[int, Alignment],
    mesh: dict[int, Mesh],
    leaves: Leaves,
    further: dict[int, FurtherCut] | None = None,
    params: AgreedTreeParams | None = None,
) -> AgreedTree:
    """The tree that the cuts agree on; without further ones the first."""
    return agreed_tree(reference, first, further or {}, alignment, mesh, leaves, params or AgreedTreeParams())


def judged(
    tree: AgreedTree,
    reference: Reference,
    alignment: dict[int, Alignment],
    mesh: dict[int, Mesh],
    leaves: Leaves,
) -> tuple[EndRings, ...]:
    """What the frames of every run show of rings."""
    runs = [tree.members("judged/frame", (k,)) for k in tree.members("judged", ())]
    return tuple(end_rings(reference, tree, {f: alignment[f] for f in run}, {f: mesh[f] for f in run}, leaves) for run in runs)


def extended(
    tree: AgreedTree,
    reference: Reference,
    alignment: dict[int, Alignment],
    mesh: dict[int, Mesh],
    leaves: Leaves,
    surface_joints: bool = True,
) -> ExtendedTree:
    """The tree with joints at ends."""
    rings, params = judged(tree, reference, alignment, mesh, leaves), ExtendedTreeParams(surface_joints=surface_joints)
    return extended_tree(reference, tree, rings, alignment, mesh, leaves, params)


def tube(trust: float) -> tuple[Reference, RigidParts, dict[int, Alignment], dict[int, Mesh], Leaves]:
    """What `first_tree` reads of a tube whose last joint only the frames show; vertices have so much confidence."""
    body, frames = aligned(turning()), Frames(turning())
    two = body._replace(label=(body.V[:, 2] > 0.0).astype(np.int64), R=body.R[:, :2], t=body.t[:, :2])
    reference, certain, leaves = task_inputs(body.V, body.F, body.x)
    trusted = {"confidence": np.full(len(body.V), trust)}
    alignment = {t: Alignment(**{**a.plain(), **a.arrays(), **trusted}) for t, a in certain.items()}
    shown = {FIRST + k: frames(k) for k in range(len(body.x))}
    mesh = {t: Mesh(vertices=V, faces=F, vertex_of_input=np.arange(len(V)), cleaning=Cleaning()) for t, (V, F) in shown.items()}
    return reference, rigid(two, reference.frames), alignment, mesh, leaves
