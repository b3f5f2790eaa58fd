"""Laws of poses between measured frames."""

import numpy as np
from limbs import rotation

from kinetree.tasks.numerics.results.complete_skeleton import CERTAINTY, Poses, interpolated, missing_frames

PARENTS = (-1, 0, 1)
REST = np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0]])


def turning(angles: list[float]) -> Poses:
    """A root that moves along z by 2 an angle, an arm that turns about z, its end."""
    R = np.stack([[np.eye(3), *[rotation((0.0, 0.0, 1.0), a)] * 2] for a in angles])
    X = np.stack([[o, o + REST[1], o + REST[1] + r[1] @ (REST[2] - REST[1])] for o, r in zip(moved(angles), R, strict=True)])
    return Poses(X, R, np.tile([0.8, 0.4, 0.4], (len(angles), 1)) - 0.1 * np.arange(len(angles))[:, None])


def moved(angles: list[float]) -> np.ndarray:
    return np.array([[0.0, 0.0, 2 * a] for a in angles])


def test_numbers_between_frames_are_missing_unless_the_gap_is_long() -> None:
    assert missing_frames((0, 1, 3, 4, 9), (), 10) == [2, 5, 6, 7, 8]
    assert missing_frames((0, 1, 3, 4, 9), (), 3) == [2]
    assert missing_frames((0, 1, 3), (), 0) == []
    assert missing_frames((0, 2, 4, 8), (), 10) == [6]
    assert missing_frames((0, 2, 4, 8), (5,), 10) == [1, 3, 5, 6, 7]
    assert missing_frames((3, 4), (1, 5), 10) == []
    assert missing_frames((7,), (), 10) == missing_frames((), (), 10) == []


def test_constant_turning_is_met_exactly() -> None:
    between = interpolated((0, 3, 6), (1, 2, 5), turning([0.0, 0.9, 1.2]), REST, PARENTS)
    expected = turning([0.3, 0.6, 1.1])
    np.testing.assert_allclose(between.positions, expected.positions, atol=1e-12)
    np.testing.assert_allclose(between.rotation, expected.rotation, atol=1e-12)


def test_bones_keep_their_lengths_and_confidence_is_low() -> None:
    between = interpolated((0, 2), (1,), turning([0.0, 2.0]), REST, PARENTS)
    assert np.allclose(np.linalg.norm(np.diff(between.positions, axis=1), axis=2), [1.0, 2.0])
    np.testing.assert_allclose(between.confidence, CERTAINTY * np.array([[0.7, 0.3, 0.3]]))
