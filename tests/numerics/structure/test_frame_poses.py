"""A pose for every frame."""

import numpy as np
import pytest
from articulated import chain, swings
from limbs import rotation

from kinetree.tasks.numerics.structure.articulated_fit import Motion
from kinetree.tasks.numerics.structure.frame_poses import FramePoses, confident_share, fit_sample, frame_poses, interpolated


def test_rotations_not_known_lie_on_the_shortest_way_between_those_known() -> None:
    turn = np.stack([rotation((0.0, 0.0, 1.0), a) for a in (0.0, 9.0, 9.0, 9.0, 0.8)])
    known = np.array([True, False, False, False, True])
    for k, filled in enumerate(interpolated(turn, known)):
        assert filled == pytest.approx(rotation((0.0, 0.0, 1.0), 0.2 * k), abs=1e-9)
    assert interpolated(turn, ~known)[0] == pytest.approx(turn[1])
    assert interpolated(turn, np.zeros(5, bool)) is turn


def hidden(frames: slice) -> tuple[FramePoses, np.ndarray]:
    """A tube whose upper link swings slowly and is seen nowhere in fit_sample frames, where it is told to be elsewhere."""
    turn = np.stack([np.tile(np.eye(3), (20, 1, 1)), np.stack([rotation((1.0, 0.0, 0.0), 0.05 * f) for f in range(20)])], 1)
    body = chain((0.0,), turn)
    trust = np.ones(body.x.shape[:2])
    gone = np.flatnonzero(body.label == 1)
    trust[frames][:, gone] = 0.0
    x = body.x.copy()
    x[frames][:, gone] = 50.0
    start = Motion(body.joints, body.R, body.t[:, 0])
    return frame_poses(body.V, x, body.area, body.label, body.W, start, body.parents, trust), body.R


def test_lost_limb_swings_on_between_the_frames_that_saw_it() -> None:
    found, R = hidden(slice(8, 13))
    assert np.abs(found.motion.R - R).max() < 0.02
    assert found.confidence[8:13, 1].max() < 0.05
    assert found.confidence[:8].min() > 0.95


def test_everything_seen_is_believed() -> None:
    body = chain((0.0,), swings(12, 2), blend=1.0)
    found = frame_poses(body.V, body.x, body.area, body.label, body.W, Motion(body.joints, body.R, body.t[:, 0]), body.parents)
    assert found.error.max() < 1e-6
    assert found.confidence == pytest.approx(np.ones((12, 2)))


def test_share_of_a_part_that_was_seen() -> None:
    trust = np.array([[1.0, 0.0, 1.0], [0.5, 0.5, 0.0]])
    share = confident_share(np.array([0, 0, 1]), np.array([1.0, 3.0, 2.0]), trust, 2, 2)
    assert share == pytest.approx(np.array([[0.25, 1.0], [0.5, 0.0]]))
    assert (confident_share(np.array([0]), np.ones(1), None, 4, 1) == 1).all()


def test_vertices_asked_stand_for_the_whole_area_of_their_part() -> None:
    label = np.arange(3000) % 7 // 6
    area = np.random.default_rng(0).uniform(1.0, 2.0, 3000)
    asked, mass = fit_sample(label, area, 2)
    assert len(asked) < 500
    assert np.bincount(label[asked], mass) == pytest.approx(np.bincount(label, area))
    few, all_of_it = fit_sample(label[:90], area[:90], 2)
    assert few.tolist() == list(range(90))
    assert all_of_it == pytest.approx(area[:90])
