"""Laws of contact: two arms that meet at their ends, at an end and a side, and along their sides."""

import numpy as np
import pytest

from kinetree.tasks.numerics.paper_2009.contact_kinds import branch_shares, contacts

COUNT = 11
SHARE = np.tile(np.linspace(0.0, 1.0, COUNT), 2)
BRANCH = np.repeat([0, 1], COUNT)


def arms(second: np.ndarray) -> np.ndarray:
    """(vertex, xyz) a line of points along x, from its leaf at 0, and a second one."""
    x = np.linspace(0.0, 10.0, COUNT)
    return np.concatenate([np.stack([x, 0 * x, 0 * x], axis=1), second])


def line(start: tuple[float, float], step: tuple[float, float]) -> np.ndarray:
    k = np.arange(COUNT)[:, None]
    return np.concatenate([np.array(start) + k * np.array(step), np.zeros((COUNT, 1))], axis=1)


@pytest.mark.parametrize(
    ("second", "kind"),
    [(line((0.0, 0.05), (0.0, 1.0)), 1), (line((5.0, 0.05), (0.0, 1.0)), 2), (line((0.0, 0.05), (1.0, 0.0)), 3)],
)
def test_three_types_of_contact(second: np.ndarray, kind: int) -> None:
    rest = arms(line((0.0, 50.0), (1.0, 0.0)))
    assert contacts(rest, arms(second), np.arange(2 * COUNT), BRANCH, SHARE, 10.0).tolist() == [[0, 1, kind]]


def test_arms_that_are_apart_do_not_touch() -> None:
    rest = arms(line((0.0, 50.0), (1.0, 0.0)))
    assert len(contacts(rest, rest, np.arange(2 * COUNT), BRANCH, SHARE, 10.0)) == 0


def test_shares_run_from_the_leaf_to_the_trunk() -> None:
    node = np.stack([np.arange(5.0), np.zeros(5), np.zeros(5)], axis=1)
    branch = np.array([-1, 0, 0, 0, 0])
    assert branch_shares(node, np.arange(5) - 1, branch, np.array([4])).tolist() == [1.0, 0.75, 0.5, 0.25, 0.0]
