"""Which way is up: feet on the ground tell it, in any axes and any unit."""

import numpy as np
import pytest

from kinetree.tasks.numerics.topology.up_direction import DIRECTIONS, up_direction


def walker(frames: int = 24) -> np.ndarray:
    """(leaf, frame, xyz) head, tail and four feet of a long body with z up, which go two by two."""
    t = np.linspace(0, 4 * np.pi, frames)
    swing = np.array([0, np.pi, np.pi, 0])[:, None] + t
    foot = np.array([[-0.2, 0.5], [0.2, 0.5], [-0.2, -0.5], [0.2, -0.5]])
    X = np.zeros((6, frames, 3))
    X[0], X[1] = [0, -1.0, 1.0], [0, 1.0, 0.7]
    X[2:, :, 0] = foot[:, :1]
    X[2:, :, 1] = foot[:, 1:] + 0.3 * np.sin(swing)
    X[2:, :, 2] = 0.25 * np.maximum(np.cos(swing), 0)
    return X


def to(X: np.ndarray, up: str) -> np.ndarray:
    """The same with another direction up and not mirrored."""
    axis, sign = "xyz".index(up[-1]), -1.0 if up.startswith("-") else 1.0
    Q = np.zeros((3, 3))
    Q[axis, 2] = sign
    Q[(axis + 2) % 3, 1] = Q[(axis + 1) % 3, 0] = 1.0
    Q[:, 0] *= np.linalg.det(Q)
    return X @ Q.T


@pytest.mark.parametrize("up", ["y", "z", "-y"])
def test_walking_body_has_its_feet_down(up: str) -> None:
    estimate = up_direction(to(walker(), up))
    assert DIRECTIONS[estimate.direction] == up
    assert estimate.confidence > 0.1


def test_unit_and_place_of_the_body_change_nothing() -> None:
    one, other = up_direction(walker()), up_direction(1000 * walker() + [5e3, -2e3, 7e3])
    assert one.direction == other.direction
    assert one.confidence == pytest.approx(other.confidence)


def test_leaf_that_is_not_seen_for_a_while_changes_no_direction() -> None:
    X = walker()
    X[0, 5:9] = X[3, 12:] = np.nan
    assert DIRECTIONS[up_direction(X).direction] == "z"


@pytest.mark.parametrize("X", [np.zeros((0, 7, 3)), np.zeros((1, 7, 3)), np.zeros((2, 7, 3)), np.full((3, 7, 3), np.nan)])
def test_nothing_to_tell_by_is_no_confidence(X: np.ndarray) -> None:
    assert up_direction(X) == (1, 0.0)
