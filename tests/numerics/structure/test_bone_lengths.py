"""Laws of the lengths of bones before they are held."""

import numpy as np
import pytest
from articulated import chain, swings

from kinetree.tasks.numerics.structure.bone_lengths import free_bone_lengths


def test_bones_of_rigid_parts_that_share_joints_have_one_length() -> None:
    body = chain((-1.0, 2.0), swings(10, 3))
    rest, parents = np.concatenate([body.joints, [[0.0, 0.0, 5.0]]]), np.array([-1, 0, 1, 2])
    length = free_bone_lengths(rest, parents, np.array([0, 1, 2, -1]), body.R, body.t)
    assert length == pytest.approx(np.broadcast_to([0.0, 1.5, 3.0, 3.0], (10, 4)))


def test_a_joint_lies_half_way_between_where_its_parts_have_it() -> None:
    body = chain((-1.0, 2.0), np.tile(np.eye(3), (4, 3, 1, 1)))
    t = body.t.copy()
    t[2, 2, 2] += 0.5
    length = free_bone_lengths(body.joints, np.array([-1, 0, 1]), np.arange(3), body.R, t)
    assert length[:, 2] == pytest.approx([3.0, 3.0, 3.25, 3.0])
    assert length[:, 1] == pytest.approx(np.full(4, 1.5))
