"""A cut in another pose as the task gives it."""

import numpy as np
from aligned_body import FIRST, given
from articulated import three_arms

from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import PruningParams
from kinetree.schemas.structure.rigid_parts import RigidPartsParams
from kinetree.tasks.methods import METHODS
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.structure.cut_joints import cut_joints
from kinetree.tasks.numerics.structure.end_effectors import leaf_vertices
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut
from kinetree.tasks.structure.further_cut import further_cut
from kinetree.tasks.structure.kinematic_tree import tree_settings


def cut(frame: int, **params: float) -> FurtherCut:
    body = three_arms()
    reference, aligned, leaves = given(body.V, body.F, body.x)
    poses = CutPoses(frames=(frame,), settings=RigidPartsParams(**params))
    return further_cut(poses, reference, aligned, leaves, PruningParams(), (frame,))


def doubted(trust: float, **params: float) -> tuple[FurtherCut, np.ndarray]:
    """The cut in the sixth frame where vertices have so much confidence, and its joints as the numerics have them."""
    body, frame = three_arms(), FIRST + 5
    reference, certain, leaves = given(body.V, body.F, body.x)
    trusted = {"confidence": np.full(len(body.V), trust)}
    aligned = {t: Alignment(**{**a.plain(), **a.arrays(), **trusted}) for t, a in certain.items()}
    poses, chosen = CutPoses(frames=(frame,), settings=RigidPartsParams()), PruningParams(**params)
    found = further_cut(poses, reference, aligned, leaves, chosen, (frame,))
    at = leaves.frames.index(reference.frame)
    ends = leaf_vertices(reference.vertices, leaves.positions[:, at], leaves.rows[:, at], leaves.kept)
    surface = MovingSurface(body.V, body.F.astype(np.int64), body.x, surface_areas(body.V, body.F), None)
    label = found.label.astype(np.int64)
    own = Cut(body.x[5], label, np.array(found.rotation), np.array(found.translation), np.array(found.residual))
    return found, cut_joints(surface, own, ends, np.full(body.x.shape[:2], trust), tree_settings(chosen))


def test_parts_are_carried_from_the_pose_of_the_cut() -> None:
    body, frame = three_arms(), FIRST + 5
    found = cut(frame)
    assert found.frame == frame
    pose = body.x[5]
    carried = np.einsum("fvij,vj->fvi", found.rotation[:, found.label], pose) + found.translation[:, found.label]
    away = np.linalg.norm(carried - body.x, axis=2)
    assert np.median(away) < 0.01 * np.ptp(body.V)
    for arm in (1, 2, 3):
        far = body.label == arm
        assert (found.label[far] == np.bincount(found.label[far]).argmax()).mean() > 0.9


def test_it_is_cut_by_the_settings_of_the_first_cut() -> None:
    assert cut(FIRST + 5, removal_cost=100.0).rotation.shape[1] == 1 < cut(FIRST + 5).rotation.shape[1]


def test_its_joints_are_carried_through_all_frames_before_the_tree_is_made() -> None:
    found, alone = doubted(0.9)
    assert found.joined
    assert found.joints.shape == (len(three_arms().x), 3, 3), "one for each arm"
    np.testing.assert_array_equal(found.joints, alone)


def test_of_the_block_of_the_tree_it_sees_how_much_a_joint_turns_and_nothing_else() -> None:
    task = METHODS["mesoscopic"].by_name["further_cut"]
    assert task.block == "kinematic_tree"
    assert task.params is not None
    assert set(task.params.model_fields) == {"degrees", "ratio"}
    assert doubted(0.9, degrees=170.0)[0].joints.shape[1] == 0


def test_where_the_frames_give_the_correspondence_its_joints_wait_for_the_first_cut() -> None:
    found = cut(FIRST + 5)
    assert not found.joined
    assert found.joints.shape[1] == 0
