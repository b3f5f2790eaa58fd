"""Laws of nodes that move as one, on a tube with one joint and on matrices whose gain is known."""

import numpy as np
import pytest
from limbs import LENGTH, rotation, tube
from shipped import GRAPH

from kinetree.tasks.numerics.registration.deformation import Pose, at_rest
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph
from kinetree.tasks.numerics.registration.rigid_clusters import RigidClustersSettings, rigid_clusters

ANGLES = (0.3, 0.6, 0.9)


@pytest.fixture(scope="module")
def body():
    return deformation_graph(*tube(), GRAPH._replace(nodes=80))


def folded(body, angle):
    """The half of the tube above the joint turned about x as one."""
    upper = body.g[:, 2] > 0
    R = np.tile(np.eye(3), (len(body.g), 1, 1))
    R[upper] = rotation((1, 0, 0), angle)
    return Pose(R, np.einsum("jxy,jy->jx", R, body.g))


def test_two_bones_are_two_clusters(body):
    label = rigid_clusters(body, [folded(body, angle) for angle in ANGLES])
    upper = body.g[:, 2] > 0
    assert len(np.unique(label)) == 2
    assert len(np.unique(label[upper])) == len(np.unique(label[~upper])) == 1


def test_a_body_that_never_bends_is_one_cluster(body):
    R = rotation((1, 2, 3), 1.0)
    turned = Pose(np.tile(R, (len(body.g), 1, 1)), body.g @ R.T + LENGTH)
    assert rigid_clusters(body, [at_rest(body), turned]).max() == 0


def test_bones_that_one_take_bends_are_two_clusters_though_others_hold_them(body):
    poses = [*[at_rest(body)] * 60, folded(body, 0.12), folded(body, 0.2)]
    assert rigid_clusters(body, poses).max() == 0
    label = rigid_clusters(body, poses, takes=[slice(0, 60), slice(60, 62)])
    np.testing.assert_array_equal(label, rigid_clusters(body, poses[60:]))
    assert label.max() == 1


def test_roll_about_its_own_axis_parts_a_tube_too(body):
    upper = body.g[:, 2] > 0
    R = np.tile(np.eye(3), (len(body.g), 1, 1))
    R[upper] = rotation((0, 0, 1), 1.2)
    label = rigid_clusters(body, [Pose(R, np.einsum("jxy,jy->jx", R, body.g))])
    assert len(np.unique(label)) == 2


def test_no_cost_allowed_leaves_every_node_of_a_bending_tube_to_itself(body):
    assert len(np.unique(rigid_clusters(body, [folded(body, 0.5)], RigidClustersSettings(cost=-1.0)))) == len(body.g)


def test_the_order_of_frames_and_the_scale_change_nothing(body):
    rng = np.random.default_rng(1)
    poses = [
        Pose(p.rotation, p.translation + 0.02 * rng.standard_normal(p.translation.shape))
        for p in (folded(body, angle) for angle in ANGLES)
    ]
    first = rigid_clusters(body, poses)
    np.testing.assert_array_equal(first, rigid_clusters(body, poses[::-1]))
    larger = deformation_graph(1024.0 * body.V, body.F, GRAPH._replace(nodes=80))
    scaled = [Pose(p.rotation, 1024.0 * p.translation) for p in poses]
    np.testing.assert_array_equal(larger.node, body.node)
    np.testing.assert_array_equal(first, rigid_clusters(larger, scaled))
