"""Laws of bending a reference onto a frame, on tubes whose every point's way is known."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from limbs import LENGTH, bent, rotation, tube
from shipped import FITTING, GRAPH

from kinetree.tasks.numerics.registration.block_system import add_data, conjugate_gradients
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph
from kinetree.tasks.numerics.registration.edges import add_edges, edge_energy, strains
from kinetree.tasks.numerics.registration.graph_kinematics import deformed, stepped, turned

FEW = GRAPH._replace(nodes=80)


def moved(body, R, t):
    """The pose in which the whole body is turned and shifted."""
    return Pose(np.tile(R, (len(body.node), 1, 1)), body.g @ R.T + t)


def framed(body, V, F):
    return Target.of(V, F, body.size)


def test_at_rest_the_body_is_its_reference(body):
    x, n = shape(body, at_rest(body))
    np.testing.assert_allclose(x, body.V, atol=1e-12 * body.size)
    np.testing.assert_allclose(n, body.N, atol=1e-12)


def test_nodes_that_move_as_one_move_the_body_rigidly(body):
    R, t = rotation((1, 2, 3), 2.0), np.array([3.0, -1.0, 2.0])
    x, n = shape(body, moved(body, R, t))
    np.testing.assert_allclose(x, body.V @ R.T + t, atol=1e-12 * body.size)
    np.testing.assert_allclose(n, body.N @ R.T, atol=1e-12)
    assert strains(body.edge, *moved(body, R, t), body.g).max() < 1e-24


def test_a_frame_that_is_the_reference_leaves_it_where_it_is(body):
    found = fit(body, at_rest(body), framed(body, body.V, body.F), FITTING).pose
    np.testing.assert_allclose(shape(body, found)[0], body.V, atol=1e-9 * body.size)


@pytest.mark.parametrize("angle", [0.1, 0.3])
def test_a_rigid_motion_is_reproduced_to_a_millionth_of_the_size(body, angle):
    R, t = rotation((1, 0, 0.5), angle), np.array([0.2, 0.1, -0.1])
    V = body.V @ R.T + t
    many = replace(FITTING, steps=30, point_weight=(0.05, 0.05), searches=8, solver_steps=100)
    found = fit(body, at_rest(body), framed(body, V, body.F), many).pose
    assert np.abs(shape(body, found)[0] - V).max() < 1e-6 * body.size


@pytest.mark.parametrize("angle", [0.3, 0.6, -0.5])
def test_a_bent_tube_cut_otherwise_is_followed_within_a_hundredth_of_its_length(body, angle):
    other, F = tube(around=29, along=57, start=0.07)
    pose = at_rest(body)
    for part in (angle / 2, angle):
        pose = fit(body, pose, framed(body, bent(other, part), F), FITTING).pose
    error = np.linalg.norm(shape(body, pose)[0] - bent(body.V, angle), axis=1)
    assert error.mean() < 0.005 * LENGTH
    assert np.quantile(error, 0.95) < 0.01 * LENGTH


def test_a_body_whose_every_vertex_is_a_node_follows_a_bend():
    V, F = tube(around=12, along=24)
    coarse = deformation_graph(V, F, GRAPH)
    assert len(coarse.node) == len(V)
    found = fit(coarse, at_rest(coarse), framed(coarse, bent(V, 0.3), F), FITTING)
    assert np.linalg.norm(shape(coarse, found.pose)[0] - bent(V, 0.3), axis=1).mean() < 0.02 * LENGTH


def test_energy_never_rises_over_a_step_and_falls_over_the_first(body):
    other, F = tube(around=29, along=57)
    energy = fit(body, at_rest(body), framed(body, bent(other, 0.5), F), FITTING).energy
    assert (energy[:, 1] <= energy[:, 0]).all()
    assert energy[0, 1] < 0.9 * energy[0, 0]


def test_scale_and_place_change_nothing_but_rounding(body):
    V, F = bent(body.V, 0.3), body.F
    found = shape(body, fit(body, at_rest(body), framed(body, V, F), FITTING).pose)[0]
    big = deformation_graph(1024 * body.V, body.F, FEW)
    again = shape(big, fit(big, at_rest(big), framed(big, 1024 * V, F), FITTING).pose)[0]
    np.testing.assert_allclose(again / 1024, found, atol=1e-6 * body.size)


def test_the_order_of_a_frames_vertices_changes_nothing_but_rounding(body):
    V, F = tube(around=29, along=57, start=0.07)
    V = bent(V, 0.3) * (1 + 0.001 * np.random.default_rng(0).normal(size=(len(V), 1)))
    order = np.random.default_rng(1).permutation(len(V))
    place = np.argsort(order)
    one, two = (fit(body, at_rest(body), framed(body, *f), FITTING).pose for f in ((V, F), (V[order], place[F])))
    np.testing.assert_allclose(shape(body, two)[0], shape(body, one)[0], atol=1e-6 * body.size)


def test_results_are_equal_to_the_last_bit_again_and_in_threads(body):
    V, F = tube(around=29, along=57)

    def once(angle):
        return np.concatenate([x.ravel() for x in fit(body, at_rest(body), framed(body, bent(V, angle), F), FITTING).pose])

    angles = [0.1, 0.2, 0.3, 0.4]
    alone = [once(a) for a in angles]
    with ThreadPoolExecutor(4) as pool:
        for a, b in zip(alone, pool.map(once, angles), strict=True):
            np.testing.assert_array_equal(a, b)


def test_a_frame_that_lacks_half_a_limb_still_gives_finite_poses(body):
    V, F = tube(around=29, along=57)
    half = F[(V[F, 2] < 1).all(axis=1)]
    used = np.unique(half)
    found = fit(body, at_rest(body), framed(body, V[used], np.searchsorted(used, half)), FITTING)
    assert np.isfinite(found.pose.rotation).all()
    assert np.abs(shape(body, found.pose)[0] - body.V).max() < 0.2 * LENGTH


def test_a_frame_out_of_reach_leaves_the_pose_as_it_was(body):
    found = fit(body, at_rest(body), framed(body, body.V + 100.0, body.F), FITTING).pose
    np.testing.assert_allclose(shape(body, found)[0], body.V, atol=1e-9)


def test_rotations_stay_rotations(body):
    V, F = tube(around=29, along=57)
    R = fit(body, at_rest(body), framed(body, bent(V, 0.5), F), FITTING).pose.rotation
    np.testing.assert_allclose(R @ R.transpose(0, 2, 1), np.tile(np.eye(3), (len(R), 1, 1)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(R), 1.0)


def test_a_step_is_a_turn_about_its_vector_and_half_of_it_half_the_turn():
    R, p = np.eye(3)[None], np.zeros((1, 3))
    step = np.array([[0.0, 0.0, np.pi / 2, 1.0, 2.0, 3.0]])
    turn, shift = stepped(R, p, step, 1.0)
    np.testing.assert_allclose(turn[0], rotation((0, 0, 1), np.pi / 2), atol=1e-12)
    np.testing.assert_allclose(shift[0], [1, 2, 3])
    np.testing.assert_allclose(stepped(R, p, step, 0.5)[0][0], rotation((0, 0, 1), np.pi / 4), atol=1e-12)


def _system(body, pose, vertex, point, normal):
    """Blocks of the normal equations as one dense matrix, and their right side."""
    nodes = len(body.node)
    D, B, b = np.zeros((nodes, 6, 6)), np.zeros((len(body.pair), 6, 6)), np.zeros((nodes, 6))
    x = deformed(body.V, body.bound, body.weight, body.g, *pose)[vertex]
    plane, near = np.full(len(vertex), 0.7), np.full(len(vertex), 0.2)
    graph = (body.V, body.bound, body.weight, body.of_vertex)
    add_data(D, B, b, *graph, pose.rotation, body.g, vertex, x - point, normal, plane, near)
    add_edges(D, B, b, body.edge, body.of_edge, np.full(len(body.edge), 0.3), *pose, body.g)
    A = np.zeros((nodes, 6, nodes, 6))
    A[np.arange(nodes), :, np.arange(nodes), :] = D
    for block, (j, k) in zip(B, body.pair, strict=True):
        A[j, :, k, :], A[k, :, j, :] = block, block.T
    return D, B, b, A.reshape(6 * nodes, -1)


def _energy(body, pose, vertex, point, normal):
    r = deformed(body.V, body.bound, body.weight, body.g, *pose)[vertex] - point
    edges = edge_energy(body.edge, np.full(len(body.edge), 0.3), *pose, body.g)
    return 0.7 * (np.einsum("rx,rx->r", r, normal) ** 2).sum() + 0.2 * (r**2).sum() + edges


def test_blocks_are_the_normal_equations_of_the_energy_and_cg_solves_them():
    rng = np.random.default_rng(0)
    body = deformation_graph(*tube(around=10, along=14), GRAPH._replace(nodes=9))
    start = Pose(*stepped(*at_rest(body), 0.1 * rng.normal(size=(9, 6)), 1.0))
    vertex = rng.integers(len(body.V), size=60)
    point = body.V[vertex] + 0.1 * rng.normal(size=(60, 3))
    normal = turned(body.N, body.bound, body.weight, start.rotation)[vertex]
    D, B, b, A = _system(body, start, vertex, point, normal)
    np.testing.assert_allclose(A, A.T, atol=1e-10)
    slope = np.empty((9, 6))
    for j in range(9):
        for a in range(6):
            step = np.zeros((9, 6))
            step[j, a] = 1e-5
            ahead, behind = (_energy(body, Pose(*stepped(*start, step, s)), vertex, point, normal) for s in (1.0, -1.0))
            slope[j, a] = (ahead - behind) / 2e-5
    np.testing.assert_allclose(b, -slope / 2, atol=1e-5)
    D[:, range(6), range(6)] += 1e-3
    x = conjugate_gradients(D, np.linalg.inv(D), B, body.pair, b, 500, 1e-12)
    np.testing.assert_allclose(x.ravel(), np.linalg.solve(A + 1e-3 * np.eye(len(A)), b.ravel()), atol=1e-6)
