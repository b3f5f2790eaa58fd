"""Laws of the pose in one frame by itself."""

import numpy as np
import pytest
from fitting import FRAMES, arms, true
from smeared import END, Frames, aligned, turning

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_frame import SkinnedBody
from kinetree.tasks.numerics.structure.further_pose import further_pose
from kinetree.tasks.numerics.structure.pose_refinement import KnownPoses

KNOWN, BODY = arms()
POSES = KnownPoses(KNOWN.R[:10], np.ones((10, 4)))
BEHIND = np.arange(10, 0, -1)


def degrees(R: np.ndarray, true: np.ndarray) -> np.ndarray:
    """(part,) angle between rotations."""
    cosine = (np.einsum("pxy,pxy->p", R, true) - 1.0) / 2.0
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def test_exact_vertices_give_the_exact_pose() -> None:
    for frame in (10, FRAMES - 1):
        found = further_pose(BODY, KNOWN.x[frame], None, POSES, BEHIND)
        assert degrees(found.pose.R, KNOWN.R[frame]).max() < 0.01
        np.testing.assert_allclose(found.pose.x, true(KNOWN, frame).x, atol=1e-4)
        assert found.seen.all()
        assert found.confidence.min() > 0.99


def test_a_part_that_is_not_seen_is_held_as_in_the_nearest_frame_that_saw_it() -> None:
    confidence = np.where(KNOWN.label == 2, 0.0, 1.0)
    spoilt = KNOWN.x[12] + 8.0 * (KNOWN.label == 2)[:, None]
    known = POSES._replace(confidence=np.where(np.arange(10)[:, None] == 9, np.where(np.arange(4) == 2, 0.1, 1.0), 1.0))
    found = further_pose(BODY, spoilt, confidence, known, BEHIND)
    assert found.seen.tolist() == [True, True, False, True]
    held = KNOWN.R[12, 0] @ KNOWN.R[8, 0].T @ KNOWN.R[8, 2]  # frame 9 did not see it
    assert degrees(found.pose.R, np.stack([*KNOWN.R[12, :2], held, KNOWN.R[12, 3]])).max() < 1.0
    assert found.confidence[2] < 0.01 < 0.99 < found.confidence[1]


def body_with_end(empty: int = 0) -> tuple[SkinnedBody, KnownPoses]:
    """A tube of three parts, the last beyond an end joint, and so many parts without vertices below the first."""
    smeared, frames = aligned(turning()), Frames(turning())
    part = (smeared.V[:, 2] > 0.0).astype(int) + (smeared.V[:, 2] > END)
    bound, weight = np.zeros((len(part), 4), np.int64), np.tile(np.eye(4)[0], (len(part), 1))
    bound[:, 0] = part + empty * (part > 0)
    from_three = np.array([0] * (1 + empty) + [1, 2])
    rest = frames.true.joints[from_three]
    body = SkinnedBody.of(smeared.V, smeared.F, bound, weight, rest, np.arange(3 + empty) - 1)
    return body, KnownPoses(frames.true.R[:8, from_three], np.ones((8, 3 + empty)))


def test_the_part_above_an_end_may_have_no_vertices() -> None:
    smeared, frames, away = aligned(turning()), Frames(turning()), np.array([0.0, 30.0, 0.0])
    V, F = frames(11)
    found = []
    for empty in (0, 2):
        body, known = body_with_end(empty)
        target = Target.of(V + away, F, body.size)
        pose = further_pose(body, smeared.x[11] + away, None, known, 11 - np.arange(8), (2 + empty,), lambda t=target: t)  # type: ignore[misc]
        found.append(pose.pose.R[[0, 1 + empty, 2 + empty]])
    assert degrees(*found).max() < 0.1


@pytest.mark.parametrize("certain", [1.0, 0.1])
def test_an_end_that_the_alignment_smears_turns_as_its_surface_does(certain: float) -> None:
    smeared, frames = aligned(turning()), Frames(turning())
    body, known = body_with_end()
    confidence = np.where(body.label > 0, certain, 1.0)
    asked = []

    def surface(frame: int) -> Target:
        asked.append(frame)
        return Target.of(*frames(frame), body.size)

    off = []
    for frame in (11, 17, 22):
        behind = frame - np.arange(8)
        for ends in ((), (2,)):
            found = further_pose(body, smeared.x[frame], confidence, known, behind, ends, lambda f=frame: surface(f))  # type: ignore[misc]
            axis = found.pose.R[2, :, 2] @ frames.true.R[frame, 2, :, 2]
            off.append(np.degrees(np.arccos(min(axis, 1.0))))
    without, with_end = np.reshape(off, (3, 2)).T
    if certain == 1.0:
        assert asked == [11, 17, 22]
        assert without.max() > 12.0
        assert with_end.max() < 3.0
    else:
        assert asked == []
        np.testing.assert_array_equal(without, with_end)
