"""A cut in another pose as the task gives it."""

import numpy as np
from aligned_body import FIRST, given
from articulated import three_arms

from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.rigid_parts import RigidPartsParams
from kinetree.tasks.structure.further_cut import further_cut


def cut(frame: int, **params: float) -> FurtherCut:
    body = three_arms()
    reference, aligned, leaves = given(body.V, body.F, body.x)
    poses = CutPoses(frames=(frame,), settings=RigidPartsParams(**params))
    return further_cut(poses, reference, aligned, leaves, (frame,))


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
