"""Laws of joints at edges: a chain of nodes that bends between two clusters."""

import numpy as np
from articulated import chain

from kinetree.tasks.numerics.paper_2009.edge_joints import NodeMotion, edge_joints


def test_joint_is_amid_the_edge_at_which_clusters_meet() -> None:
    body = chain((0.0,))
    z = np.array([-4.0, -2.0, -1.0, 1.0, 2.0, 4.0])
    node = np.stack([0 * z, 0 * z, z], axis=1)
    cluster = np.repeat([0, 1], 3)
    joint = np.concatenate([node[:1], (node[1:] + node[:-1]) / 2])
    R, t = body.R[:, cluster], body.t[:, cluster]
    X = np.einsum("tnxy,ny->tnx", R, node) + t
    label = np.abs(body.V[:, 2:] - z).argmin(axis=1)
    bound = np.stack([label] + [0 * label] * 3, axis=1)
    weight = np.stack([np.ones(len(label))] + [np.zeros(len(label))] * 3, axis=1)
    tip = np.array([int(body.V[:, 2].argmax())])
    motion = NodeMotion(node, joint, np.arange(6) - 1, cluster, X, R)
    tree = edge_joints(motion, body.V, label, bound, weight, np.array([5]), tip, 10.0)
    assert tree.kinds == ("root", "joint", "leaf")
    assert np.allclose(tree.rest[1], 0.0)
    assert np.allclose(tree.positions[:, 1], body.t[:, 1] + body.R[:, 1] @ body.joints[1])
    assert tree.confidence.min() > 0.99
