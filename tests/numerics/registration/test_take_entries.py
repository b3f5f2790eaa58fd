"""Laws of the frame by which a take is entered."""

import numpy as np
import pytest
from limbs import rotation

from kinetree.tasks.numerics.registration.take_entries import Limbs, likely_turns, take_entries

SPREAD = np.array([[1.0, 0.2, 0.1], [-0.9, 0.3, 0.0], [0.4, -1.2, 0.2], [-0.5, -1.1, -0.3], [0.1, 0.9, 0.4]])


def bent(angle: float, *, turn: np.ndarray | None = None, shift: float = 0.0, size: float = 2.0, order: int = 0) -> Limbs:
    """Five limbs of three points, the first of which is bent; the body turned, moved and scaled, its limbs in another order."""
    stems = SPREAD[:, None] * np.array([0.3, 0.7, 1.0])[None, :, None]
    stems[0, 2] = stems[0, 1] + rotation((0, 0, 1), angle) @ (stems[0, 2] - stems[0, 1])
    R = np.eye(3) if turn is None else turn
    return Limbs(size * (np.roll(stems, order, axis=0) @ R.T) + shift, np.full(3, shift), size)


@pytest.mark.parametrize("degrees", [0, 20, 90, 160, 250])
def test_a_pose_is_the_same_wherever_the_body_stands_and_faces(degrees: int) -> None:
    turn = rotation((0, 0, 1), np.radians(degrees))
    R, distance = likely_turns(bent(0.8), bent(0.8, turn=turn, shift=30.0, size=5.0, order=2))
    assert distance[0] < 1e-6
    np.testing.assert_allclose(R[0], turn, atol=1e-6)


def test_a_body_that_is_alike_back_to_front_has_both_turns() -> None:
    stems = np.array([[x, y, z] for x in (-0.5, 0.5) for y, z in ((0.02, 0.6), (0.02, -1.0))])[:, None] * np.array(
        [[[0.2], [1.0]]]
    )
    body = Limbs(stems, np.zeros(3), 1.0)
    R, distance = likely_turns(body, body)
    np.testing.assert_allclose(R[:2], [np.eye(3), rotation((0, 0, 1), np.pi)], atol=0.05)
    assert distance[0] < 1e-6 < distance[1] < 0.1


def test_the_nearest_pose_is_the_entry_and_the_body_is_brought_there() -> None:
    turn = rotation((0, 0, 1), 1.9)
    first = [bent(angle) for angle in (0.0, 0.4, 0.8)]
    second = [bent(angle, turn=turn, shift=7.0, order=1) for angle in (2.0, 1.4, 0.85)]
    (entry,) = take_entries([*first, *second], [slice(0, 3), slice(3, 6)], 1)
    assert (entry.before, entry.at) == (2, 5)
    moved = np.roll(first[2].stems, 1, axis=0) @ entry.rotation[0].T + entry.shift[0]
    assert np.linalg.norm(moved - second[2].stems, axis=2).mean() < 0.05


def test_takes_are_reached_one_from_another_where_that_is_nearer() -> None:
    poses = [bent(angle) for angle in (0.0, 0.1, 2.0, 2.1, 1.0, 1.1)]
    entries = take_entries(poses, [slice(0, 2), slice(2, 4), slice(4, 6)], 0)
    assert [(entry.before, entry.at) for entry in entries] == [(1, 4), (5, 2)]


def test_one_take_alone_has_no_entry_and_a_body_without_limbs_is_served() -> None:
    assert take_entries([bent(0.0), bent(1.0)], [slice(0, 2)], 0) == []
    none = Limbs(np.zeros((0, 3, 3)), np.zeros(3), 1.0)
    (entry,) = take_entries([none, none], [slice(0, 1), slice(1, 2)], 0)
    assert (entry.at, entry.distance.tolist()) == (1, [0.0])
    np.testing.assert_array_equal(entry.rotation, [np.eye(3)])
