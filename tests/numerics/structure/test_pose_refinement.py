"""The finished body fitted to one frame."""

import numpy as np
import pytest
from fitting import FRAMES, arms, surface_at, tip, true, turned
from limbs import rotation

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, joints, surface
from kinetree.tasks.numerics.structure.pose_refinement import (
    KnownPoses,
    PoseRefinementSettings,
    RefinedPose,
    needs_refinement,
    refined_pose,
)

FRAME, ARM = 5, 1


def spoilt(
    angle: float, lost: int = -1, *, touched: bool = True, trust: float = 0.05
) -> tuple[RefinedPose, FramePose, FramePose]:
    """A frame in which one arm's vertices and its pose are off by an angle and little trusted, and the true pose."""
    known, body = arms()
    at = true(known, FRAME)
    start = turned(at, ARM, rotation((0.3, -0.2, 1.0), angle))
    aligned, certain = known.x[FRAME].copy(), np.ones(len(known.V))
    if touched:
        aligned[known.label == ARM] += 9.0
        certain[known.label == ARM] = trust
    R, confidence = known.R.copy(), np.ones((FRAMES, 4))
    R[FRAME], confidence[FRAME, ARM] = start.R, trust
    found = refined_pose(body, start, surface_at(known, body, FRAME, lost), aligned, certain, KnownPoses(R, confidence), FRAME)
    return found, start, at


@pytest.mark.parametrize("angle", [0.3, -0.6, 1.0, 2.1])
def test_arm_whose_vertices_are_spoilt_is_brought_back_by_its_surface_alone(angle: float) -> None:
    found, start, at = spoilt(angle)
    _, body = arms()
    assert found.moved
    off = [np.linalg.norm(tip(body, p, ARM) - tip(body, at, ARM)) / body.size for p in (start, found.pose)]
    assert off[1] < 0.01 < 0.05 < off[0]
    assert joints(body, found.pose) == pytest.approx(joints(body, at), abs=0.01 * body.size)
    assert found.confidence[ARM] > 0.5
    assert found.after < found.before


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_arm_without_any_surface_keeps_its_pose_and_is_not_believed(angle: float) -> None:
    found, start, _ = spoilt(angle, lost=ARM)
    _, body = arms()
    assert np.linalg.norm(tip(body, found.pose, ARM) - tip(body, start, ARM)) < 0.01 * body.size
    assert found.confidence[ARM] <= 0.05


@pytest.mark.parametrize(("degrees", "goes_back"), [(30.0, True), (90.0, False)])
def test_part_that_turns_as_it_was_seen_nowhere_goes_back(degrees: float, goes_back: bool) -> None:
    settings = PoseRefinementSettings(strange_turn=np.deg2rad(degrees))
    known, body = arms(2.0)
    at = true(known, FRAME)
    V, _ = surface(body, turned(at, ARM, rotation((0.3, -0.2, 1.0), 0.8)))
    trust, confidence = np.where(known.label == ARM, 0.05, 1.0), np.ones((FRAMES, 4))
    confidence[FRAME, ARM] = 0.05
    target = Target.of(V, known.F, body.size)
    found = refined_pose(body, at, target, known.x[FRAME], trust, KnownPoses(known.R, confidence), FRAME, settings)
    off = np.linalg.norm(tip(body, found.pose, ARM) - tip(body, at, ARM)) / body.size
    assert bool(off < 0.02) == goes_back
    assert bool(found.confidence[ARM] < 0.3) == goes_back


def test_pose_that_is_right_stays_as_it_was() -> None:
    found, start, _ = spoilt(0.0, touched=False)
    assert not found.moved
    assert found.pose is start
    assert found.before == found.after


def test_bones_keep_their_lengths() -> None:
    _, body = arms()
    X = joints(body, spoilt(1.0)[0].pose)
    rest = np.linalg.norm(body.rest[1:] - body.rest[body.parents[1:]], axis=1)
    assert np.linalg.norm(X[1:] - X[body.parents[1:]], axis=1) == pytest.approx(rest)


def test_one_part_in_doubt_is_enough_for_a_frame() -> None:
    assert needs_refinement(np.array([[1.0, 0.9], [1.0, 0.2], [0.5, 0.1]])).tolist() == [False, True, True]
