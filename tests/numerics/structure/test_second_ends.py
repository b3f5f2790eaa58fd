"""Laws of ends beside the tip of a limb."""

import numpy as np
import pytest
from articulated import chain
from shapes import y_pipe

from kinetree.tasks.numerics.structure.second_ends import SecondEndsSettings, second_ends

V, F, _ = y_pipe()
TIPS = np.argmax(V @ np.stack([[np.cos(a), np.sin(a), 0.0] for a in 2 * np.pi * np.arange(3) / 3]).T, axis=0)
"""Vertices at the tips of the three arms; the first lies along x."""
FORK = (V[:, 0] < 12).astype(np.int64)
"""The first arm is the root, the middle with both others is the last part."""
PARENTS = np.array([-1, 0])


@pytest.mark.parametrize("tip", [1, 2])
def test_a_part_that_forks_also_ends_in_the_prong_that_is_no_leaf(tip: int) -> None:
    ends = second_ends(V, F, FORK, PARENTS, TIPS[[tip]])
    assert np.linalg.norm(V[ends] - V[TIPS[3 - tip]], axis=1) == pytest.approx([0.0], abs=5.0)


def test_a_fork_without_a_leaf_has_one_second_end() -> None:
    assert len(second_ends(V, F, FORK, PARENTS, np.zeros(0, np.int64))) == 1


def test_a_part_whose_tips_are_known_has_no_further_ends() -> None:
    assert len(second_ends(V, F, FORK, PARENTS, TIPS)) == 0


def test_neither_a_plain_limb_nor_the_root_has_second_ends() -> None:
    tube = chain((-2.0, 2.0))
    assert len(second_ends(tube.V, tube.F, tube.label, tube.parents, np.zeros(0, np.int64))) == 0
    assert len(second_ends(V, F, 1 - FORK, PARENTS, TIPS[:1])) == 0


def test_a_part_that_another_hangs_on_has_no_second_ends() -> None:
    label = np.where(V[:, 0] < -9, np.where(V[:, 1] > 0, 2, FORK), FORK)
    assert len(second_ends(V, F, label, np.array([-1, 0, 1]), TIPS[1:])) == 0


def test_ends_are_the_same_at_any_scale_and_place() -> None:
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    bent = V + 0.01 * V[:, 1:2] ** 2 * [0.0, 0.0, 1.0] + [0.0, 1e-3, 0.0] * V[:, 1:2]  # no two prongs alike
    ends = second_ends(bent, F, FORK, PARENTS, TIPS[1:2])
    assert second_ends(250.0 * bent @ turn.T + 3.0, F, FORK, PARENTS, TIPS[1:2]).tolist() == ends.tolist()


@pytest.mark.parametrize("limits", [SecondEndsSettings(prominence=20.0), SecondEndsSettings(height=1.01)])
def test_what_stands_out_less_than_asked_for_is_no_end(limits: SecondEndsSettings) -> None:
    assert len(second_ends(V, F, FORK, PARENTS, TIPS[1:2], limits)) == 0
