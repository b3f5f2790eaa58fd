"""The skeleton as it is left: poses of the aligned vertices, and those of the fit in their places."""

import numpy as np
import pytest
from fitting import FIRST, FRAMES, arms, articulation
from limbs import rotation

from kinetree.pipeline import views
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.structure.further_pose import FurtherPose
from kinetree.schemas.structure.pose_refinement import PoseRefinement
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.structure.skeleton import skeleton

SEQUENCE = Sequence(frames=tuple(range(FIRST, FIRST + FRAMES)), fps=25.0, unit="mm")


def fitted(rows: tuple[int, ...], moved: bool) -> PoseRefinement:
    """An arm turned by a right angle in some frames."""
    known, _ = arms()
    of = articulation(known)
    kept = {name: np.array(getattr(of, name)[list(rows)]) for name in ("positions", "rotation", "confidence")}
    if moved:
        kept["rotation"][:, 1:3] = rotation((0.0, 0.0, 1.0), np.pi / 2)
        kept["confidence"][:, 1:3] = 0.6
    half = np.full(len(rows), 0.5)
    return PoseRefinement(
        frames=tuple(FIRST + r for r in rows), moved=np.full(len(rows), moved), before=half, after=half, **kept
    )


def test_without_a_fit_all_is_as_it_was() -> None:
    known, _ = arms()
    of = articulation(known)
    for fits in ((), (fitted((6, 7), False),)):
        found = skeleton(of, fits, (), SEQUENCE)
        assert type(found) is Skeleton
        assert (found.fps, found.unit) == (25.0, "mm")
        for name in Skeleton.array_fields():
            assert getattr(found, name).tobytes() == getattr(of, name).tobytes()


def test_fitted_frames_are_put_in_their_places() -> None:
    known, _ = arms()
    of = articulation(known)
    found = skeleton(of, (fitted((2,), True), fitted((6, 7), True)), (), SEQUENCE)
    changed = [t for t in range(FRAMES) if not np.array_equal(found.rotation[t], of.rotation[t])]
    assert changed == [2, 6, 7]
    assert found.confidence[[2, 6, 7], 1] == pytest.approx(0.6)
    assert found.degrees[1] > found.degrees[[0, 2]].max() == 0.0


def test_skeleton_says_how_many_joints_it_has() -> None:
    known, _ = arms()
    assert views.remarks(skeleton(articulation(known), (), (), SEQUENCE)) == ("3 joints and 1 leaf under root",)


def test_further_frames_stand_among_the_others_by_their_numbers() -> None:
    known, _ = arms()
    of = articulation(known)
    turned = np.array([np.eye(3), *[rotation((0.0, 0.0, 1.0), np.pi / 2)] * 4])

    def further(frame: int, *, seen: bool) -> FurtherPose:
        return FurtherPose(
            frame=frame, moved=False, positions=of.rest + frame, rotation=turned, confidence=np.full(5, 0.3),
            seen=np.array([True, seen, seen, True, True]),
        )  # fmt: skip

    before, behind = FIRST - 3, FIRST + FRAMES
    more = Sequence(frames=(before, *SEQUENCE.frames, behind), fps=None, unit=None, further=(before, behind))
    found = skeleton(of, (), (further(before, seen=False), further(behind, seen=True)), more)
    assert found.frames == more.frames
    assert found.rotation[1:-1].tobytes() == of.rotation.tobytes()
    assert found.positions[[0, -1]].tolist() == (of.rest + np.array([[[before]], [[behind]]])).tolist()
    assert (found.support - of.support).tolist() == [2, 1, 1, 2, 2]
    assert found.degrees[3] >= 90.0 - 30.0
