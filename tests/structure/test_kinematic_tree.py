"""The articulated body as the task gives it."""

import numpy as np
import pytest
from articulated import Known, chain, swings, three_arms

from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.kinematic_tree import KinematicTree, KinematicTreeParams
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.structure.kinematic_tree import kinematic_tree
from kinetree.tasks.structure.rigid_parts import tips_of

FIRST = 10


def told(body: Known, trust: np.ndarray | None = None, tips: tuple[int, ...] = (), **params: float) -> KinematicTree:
    frames = tuple(range(FIRST, FIRST + len(body.x)))
    count = len(frames)
    reference = Reference(
        frames=frames, frame=FIRST + 2, vertices=body.V, faces=body.F,
        size=float(np.sqrt(body.area.sum())), fixed=True, leaves=len(tips), free=True,
        score=np.zeros(count), before=np.array([1, 2, -1, *range(2, count - 1)]),
    )  # fmt: skip
    parts = RigidParts(
        frames=frames, label=body.label, rigid=np.ones(len(body.V)), rotation=body.R, translation=body.t, residual=body.residual
    )
    zero, one = np.zeros(len(body.V)), np.ones(len(body.V))
    aligned = {
        f: Alignment(vertices=x, residual=zero, stretch=one, trust=one if trust is None else trust[k], uncovered=0.0)
        for k, (f, x) in enumerate(zip(frames, body.x, strict=True))
    }
    positions = np.broadcast_to(body.V[list(tips), None], (len(tips), count, 3))
    leaves = Leaves(
        frames=frames, rows=np.zeros((len(tips), count), int), positions=positions, kept=np.ones((1, len(tips)), bool),
        lost=np.zeros(0, int), lost_begin=np.zeros(0, int), lost_end=np.zeros(0, int),
    )  # fmt: skip
    assert tips_of(leaves, reference).tolist() == list(tips)
    sequence = Sequence(frames=frames, fps=25.0, unit="mm")
    return kinematic_tree(reference, parts, aligned, {}, leaves, sequence, KinematicTreeParams(**params))


def test_arms_hang_on_one_root_and_end_in_their_leaves() -> None:
    body = three_arms()
    tips = tuple(int(np.argmax(body.V @ [np.cos(a), np.sin(a), 0.0])) for a in (0, 2 * np.pi / 3, 4 * np.pi / 3))
    found = told(body, tips=tips)
    assert found.names == (
        "root", "limb_a_1", "limb_a_end", "limb_b_1", "limb_b_end", "limb_c_1", "limb_c_end"
    )  # fmt: skip
    assert found.parents == (-1, 0, 1, 0, 3, 0, 5)
    assert found.kinds == ("root", *("joint", "leaf") * 3)
    assert {tuple(p) for p in found.rest[[2, 4, 6]]} == {tuple(body.V[v]) for v in tips}
    assert (found.frames[0], found.fps, found.unit) == (FIRST, 25.0, "mm")
    assert found.lengths[[1, 3, 5]] == pytest.approx(12, abs=1.0)


def test_same_input_gives_the_same_bytes() -> None:
    one, two = told(three_arms()), told(three_arms())
    for name in KinematicTree.array_fields():
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()


def test_stiff_sequence_has_a_root_alone() -> None:
    found = told(chain((0.0,), np.tile(np.eye(3), (12, 2, 1, 1))))
    assert found.kinds == ("root",)


def test_what_counts_as_a_joint_can_be_set() -> None:
    body = chain((0.0,), swings(16, 2, 10, axes=1))
    assert told(body).kinds.count("joint") == 1
    assert told(body, degrees=30.0).kinds.count("joint") == 0


def test_frame_that_is_not_trusted_has_a_pose_without_confidence() -> None:
    body = chain((0.0,), swings(16, 2))
    trust = np.ones(body.x.shape[:2])
    trust[5] = 0.0
    found = told(body, trust)
    assert np.isfinite(found.positions).all()
    assert found.confidence[5].max() < 0.05 < 0.9 < found.confidence[6].min()
    assert found.support.tolist() == [15] * len(found.names)
    assert not found.doubted.any(), "every vertex was followed: there is nothing to ask the surface"


def test_leaf_not_seen_in_the_reference_frame_is_no_end() -> None:
    frames = (3, 4)
    V = np.eye(3)
    reference = Reference(
        frames=frames,
        frame=4,
        vertices=V,
        faces=np.array([[0, 1, 2]]),
        size=1.0,
        fixed=True,
        leaves=1,
        free=True,
        score=np.zeros(2),
        before=np.array([1, -1]),
    )
    positions = np.full((3, 2, 3), np.nan)
    positions[0], positions[2] = V[1], V[2]
    none = np.zeros(0, int)
    leaves = Leaves(
        frames=frames, rows=np.array([[0, 0], [1, -1], [2, 1]]), positions=positions, kept=np.array([[True, True, False]]),
        lost=none, lost_begin=none, lost_end=none,
    )  # fmt: skip
    assert tips_of(leaves, reference).tolist() == [1]
