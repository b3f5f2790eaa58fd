"""Which poses a body is cut in once more."""

import numpy as np

from kinetree.tasks.numerics.structure.further_cut import distinct_poses


def poses(*places: float) -> np.ndarray:
    """A pair of points, the distance of which is the pose; each pose is shifted, which is none."""
    return np.array([[[0.0, 0.0, 10.0 * k], [place, 0.0, 10.0 * k]] for k, place in enumerate(places)])


def test_poses_are_those_farthest_from_the_reference_and_from_one_another() -> None:
    x = poses(0.0, 0.1, 5.0, 9.0, 4.9, 8.9)
    assert distinct_poses(x, None, 0, 1).tolist() == [3]
    assert distinct_poses(x, None, 0, 2).tolist() == [3, 4]


def test_uncertain_frames_and_poses_like_the_reference_are_left_out() -> None:
    x = poses(0.0, 1.0, 2.0, 9.0)
    confidence = np.ones((4, 2))
    confidence[3] = 0.1
    assert distinct_poses(x, confidence, 0, 1).tolist() == [2]
    assert distinct_poses(poses(1.0, 1.0, 1.0), None, 0, 2).tolist() == []
    assert distinct_poses(poses(1.0), None, 0, 2).tolist() == []
