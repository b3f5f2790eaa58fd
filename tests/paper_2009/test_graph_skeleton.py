"""Contract of graph_skeleton: joints of the body, lengths held, in both ways of placing them."""

import numpy as np
import pytest
from volumetric import volumetric


def errors(letter: bool) -> np.ndarray:
    """(arm,) mean distance of the nearest joint from each true one."""
    here = volumetric(letter=letter)
    true = np.einsum("tpxy,py->tpx", here.body.R, here.body.joints) + here.body.t
    return np.linalg.norm(here.tree.positions[:, :, None] - true[:, None, 1:], axis=3).mean(axis=0).min(axis=0)


def test_joints_are_where_arms_turn() -> None:
    assert errors(letter=False).max() < 0.3
    assert volumetric().tree.kinds.count("joint") == 3


def test_joints_of_the_letter_are_within_a_node_of_where_arms_turn() -> None:
    assert errors(letter=True).max() < 1.5


@pytest.mark.parametrize("letter", [False, True])
def test_bones_have_one_length_in_all_frames(letter: bool) -> None:
    tree = volumetric(letter=letter).tree
    child = np.flatnonzero(np.array(tree.parents) >= 0)
    length = np.linalg.norm(tree.positions[:, child] - tree.positions[:, np.array(tree.parents)[child]], axis=2)
    assert np.allclose(length, tree.lengths[child])
