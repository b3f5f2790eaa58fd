"""A cut in another pose as the task gives it."""

import numpy as np
import pytest
from aligned_body import FIRST, task_inputs
from articulated import three_arms

from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import CutJointsParams
from kinetree.schemas.structure.rigid_parts import CutParams
from kinetree.tasks.methods import METHODS
from kinetree.tasks.structure.further_cut import further_cut

FRAME = FIRST + 5


def cut(trust: float = 1.0, settings: CutParams | None = None, **params: float) -> FurtherCut:
    """In the sixth frame, where vertices have so much confidence."""
    body = three_arms()
    reference, certain, leaves = task_inputs(body.V, body.F, body.x)
    trusted = {"confidence": np.full(len(body.V), trust)}
    aligned = {t: Alignment(**{**a.plain(), **a.arrays(), **trusted}) for t, a in certain.items()}
    poses = CutPoses(frames=(FRAME,), settings=settings or CutParams())
    return further_cut(poses, reference, aligned, leaves, CutJointsParams(**params), (FRAME,))


@pytest.mark.parametrize("trust", [0.9, 1.0])
def test_its_joints_go_where_the_arms_turn_in_every_frame(trust: float) -> None:
    body, found = three_arms(), cut(trust)
    assert found.frame == FRAME
    np.testing.assert_allclose(found.rotation[2], np.tile(np.eye(3), (len(found.parents), 1, 1)), atol=1e-9)
    np.testing.assert_allclose(found.translation[2], 0.0, atol=1e-6, err_msg="the reference is the third frame")
    assert found.bare_joints.shape == (len(body.x), 3, 3), "one for each arm"
    true = np.einsum("tpxy,py->tpx", body.R, body.joints) + body.t
    away = np.linalg.norm(found.bare_joints[:, :, None] - true[:, None, 1:], axis=3).mean(axis=0)
    assert away.min(axis=0).max() < 0.05 * np.ptp(body.V)
    np.testing.assert_array_equal(found.joints_with_bones, found.bare_joints)


def test_it_is_cut_by_the_settings_of_the_first_cut() -> None:
    assert cut(settings=CutParams(removal_cost=100.0)).bare_joints.shape[1] == 0


def test_of_the_block_of_the_tree_it_sees_what_counts_as_a_joint_of_a_cut_and_nothing_else() -> None:
    task = METHODS["mesoscopic"].by_name["further_cut"]
    assert task.block == "kinematic_tree"
    assert task.params is not None
    assert set(task.params.model_fields) == {"degrees", "ratio", "hidden_bones"}
    assert cut(0.9, degrees=170.0).bare_joints.shape[1] == 0
