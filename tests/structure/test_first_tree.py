"""The tree of the first cut as the task gives it."""

import numpy as np
import pytest
from aligned_body import tube

from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.kinematic_tree import FirstTreeParams
from kinetree.tasks.methods import METHODS
from kinetree.tasks.numerics.structure import first_tree as numerics
from kinetree.tasks.structure.arguments.joint_tree import restored
from kinetree.tasks.structure.first_tree import first_tree


def tree_of_tube(trust: float) -> FirstTree:
    return first_tree(*tube(trust), FirstTreeParams())


@pytest.mark.parametrize("trust", [0.99, 1.0])
def test_other_tasks_read_what_the_numerics_gave(trust: float, monkeypatch: pytest.MonkeyPatch) -> None:
    made, whole = [], numerics.first_tree
    monkeypatch.setattr(numerics, "first_tree", lambda *a, **b: made.append(whole(*a, **b)) or made[0])
    tree, (before,) = restored(tree_of_tube(trust)), made
    assert (tree.certain_share is None) == (trust == 1.0)
    for one, other in ((tree, before), (tree.graph, before.graph)):
        for name, value in one._asdict().items():
            if isinstance(value, np.ndarray):
                np.testing.assert_array_equal(value, getattr(other, name), err_msg=name)
            elif not isinstance(value, tuple):
                assert value == getattr(other, name), name


def test_it_is_made_beside_further_cuts() -> None:
    graph = METHODS["mesoscopic"]
    assert "further_cut" not in graph.until(["first_tree"]).by_name
    assert "first_tree" not in graph.until(["further_cut"]).by_name
