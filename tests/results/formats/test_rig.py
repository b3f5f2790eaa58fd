"""Laws of what every format that moves bones needs."""

import numpy as np
import pytest
from results.rigged_bodies import skinned as truth
from results.rigged_bodies import spider
from scipy.spatial.transform import Rotation

from kinetree.tasks.results.formats.rig import (
    carried,
    children,
    local_offsets,
    local_rotations,
    quaternions,
    rest_frames,
    seconds,
    skinned,
)


def test_rest_frames_are_turns_whatever_way_the_bones_point():
    rng = np.random.default_rng(0)
    rest = rng.normal(size=(40, 3))
    parents = [-1, *(int(rng.integers(0, j)) for j in range(1, 40))]
    B = rest_frames(rest, parents)
    np.testing.assert_allclose(B @ B.transpose(0, 2, 1), np.broadcast_to(np.eye(3), B.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(B), 1.0)


@pytest.mark.parametrize("along", [(0, 1, 0), (0, -1, 0), (1, 0, 0), (0, -1, 1e-9), (0, -1, 1e-4)])
def test_bone_that_turns_back_on_itself_still_has_its_axis_along_it(along):
    rest = np.array([[0.0, 0, 0], [0, 1, 0], [0, 1, 0] + np.array(along, float)])
    B = rest_frames(rest, (-1, 0, 1))
    np.testing.assert_allclose(B[1, :, 1], np.array(along) / np.linalg.norm(along), atol=1e-8)
    np.testing.assert_allclose(B[1] @ B[1].T, np.eye(3), atol=1e-7)


def test_straight_chain_is_not_twisted_and_a_bone_without_length_goes_on_as_before():
    rest = np.array([[0.0, 0, 0], [1, 2, 3], [2, 4, 6], [2, 4, 6], [4, 8, 12]])
    B = rest_frames(rest, (-1, 0, 1, 2, 3))
    np.testing.assert_allclose(B, np.broadcast_to(B[0], B.shape), atol=1e-12)


def test_turns_and_offsets_against_the_parents_lead_back_to_every_joint():
    body = spider()
    B = rest_frames(body.rest, body.parents)
    L, offset = local_rotations(body.rotation, B, body.parents), local_offsets(body.rest, B, body.parents)
    G = [L[:, 0]]
    x = [body.positions[:, 0]]
    for j, p in list(enumerate(body.parents))[1:]:
        x.append(x[p] + np.einsum("txy,y->tx", G[p], offset[j]))
        G.append(G[p] @ L[:, j])
    np.testing.assert_allclose(np.stack(x, axis=1), body.positions, atol=1e-12)


def test_leaves_never_turn_against_their_parents():
    body = spider()
    B = rest_frames(body.rest, body.parents)
    L = local_rotations(body.rotation, B, body.parents)
    for j, kind in enumerate(body.kinds):
        if kind == "leaf":
            np.testing.assert_allclose(L[:, j], np.broadcast_to(L[0, j], L[:, j].shape), atol=1e-12)


def test_quaternions_go_on_through_whole_turns():
    angle = np.linspace(0, 4 * np.pi, 60)
    R = Rotation.from_rotvec(angle[:, None] * [0, 0.6, 0.8]).as_matrix()[:, None]
    q = quaternions(R)
    assert np.abs(np.diff(q, axis=0)).max() < 0.12
    np.testing.assert_allclose(Rotation.from_quat(q[:, 0]).as_matrix(), R[:, 0], atol=1e-12)


def test_skin_follows_the_joints_and_time_the_frames():
    body = spider(frames=(2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 22))
    np.testing.assert_allclose(skinned(body, 7), truth(body)[7], atol=1e-12)
    np.testing.assert_allclose(seconds(body, 10.0)[[0, 1, -1]], [0, 0.1, 2])
    assert children(body.parents)[0] == [1, 3, 4]


def test_a_place_is_carried_as_a_vertex_that_follows_its_joint_alone():
    body = spider()
    vertex = np.flatnonzero(body.weight[:, 0] == 1.0)[::5]
    moved = carried(body, body.influence[vertex, 0].tolist(), np.asarray(body.vertices)[vertex])
    assert len(np.unique(body.influence[vertex, 0])) > 2
    np.testing.assert_allclose(moved, np.stack([skinned(body, t)[vertex] for t in range(len(body.frames))]), atol=1e-9)
