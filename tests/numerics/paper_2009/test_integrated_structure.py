"""Laws of the integration: each branch as the structure that cuts it most often."""

import numpy as np

from kinetree.tasks.numerics.paper_2009.integrated_structure import Piecewise, branch_cuts, branch_nodes, integrated_structure


def arm(cluster: list[int], nodes: int = 9) -> Piecewise:
    """A root and one branch along x, its leaf at the far end; clusters from the root outwards."""
    x = np.linspace(0.0, 8.0, nodes)
    node = np.stack([x, 0 * x, 0 * x], axis=1)
    branch = np.where(np.arange(nodes) > 0, 0, -1)
    return Piecewise(node, np.arange(nodes) - 1, branch, np.array([nodes - 1]), np.array([7]), np.array(cluster))


def test_branch_leads_from_its_leaf_to_the_first_node_beyond_it() -> None:
    way, far = branch_nodes(arm([0] * 9), 0)
    assert way == list(range(8, -1, -1))
    assert (far[0], far[-1]) == (0.0, 1.0)


def test_cuts_are_shares_of_the_length_from_the_leaf() -> None:
    assert np.allclose(branch_cuts(arm([0, 0, 0, 0, 1, 1, 1, 1, 1]), 0), [4.5 / 8])


def test_most_detailed_branch_is_taken_over_at_the_same_shares() -> None:
    trunk_detail = arm([0] * 9)._replace(cluster=np.array([0, 1, 1, 1, 1, 1, 1, 1, 1]))
    finer = arm([0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3], nodes=17)
    one = integrated_structure([finer._replace(cluster=np.zeros(17, np.int64)), trunk_detail, finer])
    assert (one.base, one.source.tolist()) == (2, [2])
    coarse = trunk_detail._replace(cluster=np.array([0, 1, 2, 3, 4, 4, 4, 4, 4]), track=np.array([3]))
    other = integrated_structure([coarse, finer])
    assert (other.base, other.source.tolist()) == (0, [0])  # another limb


def test_cuts_of_another_structure_are_put_on_the_base() -> None:
    two = arm([0, 0, 0, 1, 1, 1, 2, 2, 2])
    base = Piecewise(
        np.concatenate([two.node, [[0.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 3.0, 0.0]]]), np.array([-1, *range(8), 0, 9, 10]),
        np.array([-1, *[0] * 8, 1, 1, 1]), np.array([8, 11]), np.array([7, 8]), np.array([0] * 9 + [1, 2, 3]),
    )  # fmt: skip
    one = integrated_structure([base, two])
    assert (one.base, one.source.tolist()) == (0, [1, 0])
    own = one.cluster[:9]
    assert [n for n in range(8) if own[n] != own[n + 1]] == [2, 5]
    assert own[0] == own[2]
