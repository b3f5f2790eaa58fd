"""Laws of the surface that nodes carry, bent onto a frame, on a tube."""

import numpy as np
import pytest
from limbs import LENGTH, bent, rotation, tube
from shipped import FITTING, GRAPH

from kinetree.tasks.numerics.paper_2009.graph_tracking import CARRIED, carried_pose, graph_tracking
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph, deformation_graph


@pytest.fixture(scope="module")
def body() -> DeformationGraph:
    return deformation_graph(*tube(), GRAPH._replace(nodes=80))


def carried(body: DeformationGraph, angle: float, off: float = 0.0) -> Pose:
    """By two nodes, one on either side of the joint, that bend the tube by an angle and shift it."""
    share = np.clip(body.V[:, 2] + 0.5, 0.0, 1.0)
    bound, weight = np.tile([0, 1], (len(body.V), 1)), np.stack([1.0 - share, share], axis=1)
    R = np.stack([np.eye(3), rotation((1, 0, 0), angle)])
    return carried_pose(body.node, bound, weight, R, bent(body.V, angle) + [off, 0.0, 0.0])


def test_nodes_that_one_rotation_carries_turn_by_it() -> None:
    V, R = np.random.default_rng(0).normal(size=(6, 3)), rotation((1, 2, 3), 2.5)
    bound, weight = np.tile([0, 1], (6, 1)), np.tile([0.3, 0.7], (6, 1))
    pose = carried_pose(np.array([1, 4]), bound, weight, np.stack([R, R]), V @ R.T)
    assert np.allclose(pose.rotation, R)
    assert np.array_equal(pose.translation, (V @ R.T)[[1, 4]])


def test_between_two_rotations_a_node_turns_by_one_in_the_middle(body: DeformationGraph) -> None:
    pose = carried(body, 1.0)
    at = np.abs(body.g[:, 2]).argmin()
    turned = np.degrees(np.arccos((np.trace(pose.rotation[at]) - 1.0) / 2.0))
    assert np.allclose(np.linalg.det(pose.rotation), 1.0)
    assert 10.0 < turned < 50.0


def test_a_frame_is_reached_from_where_the_nodes_carry_the_surface(body: DeformationGraph) -> None:
    V, F = tube(around=29, along=57, start=0.07)
    target = Target.of(bent(V, 1.2), F, body.size)
    fit = graph_tracking(body, carried(body, 1.0, off=0.05 * LENGTH), at_rest(body), target, FITTING)
    assert fit.attempt == CARRIED
    x = shape(body, fit.pose)[0]
    assert np.linalg.norm(x - bent(body.V, 1.2), axis=1).mean() < 0.01 * LENGTH


def test_where_the_nodes_are_lost_the_neighbouring_frame_is_the_start(body: DeformationGraph) -> None:
    V, F = tube(around=29, along=57, start=0.07)
    target = Target.of(bent(V, 0.2), F, body.size)
    lost = carried(body, 2.4, off=3.0 * LENGTH)
    fit = graph_tracking(body, lost, at_rest(body), target, FITTING)
    assert fit.attempt >= 0
    assert np.linalg.norm(shape(body, fit.pose)[0] - bent(body.V, 0.2), axis=1).mean() < 0.01 * LENGTH
