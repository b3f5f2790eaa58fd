"""Contract of complete_skeleton: dropped and missing frames have poses in files, and are named."""

import json

import numpy as np
import pytest
from results.plain_names import plain
from results.rigged_bodies import bars_of, spider

from kinetree.pipeline import views
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.input.source import BadFrame
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton, CompleteSkeletonParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.input.frame_numbers import TAKE
from kinetree.tasks.results.complete_skeleton import complete_skeleton
from kinetree.tasks.results.skeleton_json import skeleton_json
from kinetree.tasks.structure.error_bars import unknown_error_bars

WHOLE = spider()
POSES = ("positions", "rotation", "confidence")


def without(*rows: int, **options: object) -> tuple[Skeleton, Sequence]:
    """The spider without some frames."""
    rows_left = [t for t in range(len(WHOLE.frames)) if t not in rows]
    frames = tuple(WHOLE.frames[t] for t in rows_left)
    poses = {name: np.array(getattr(WHOLE, name))[rows_left] for name in POSES}
    fields = {**{name: getattr(WHOLE, name) for name in Skeleton.model_fields}, **poses, "frames": frames}
    return Skeleton(**fields), Sequence(frames=frames, fps=None, unit=None, **options)


def completed(*rows: int, longest: int = 10, **options: object) -> CompleteSkeleton:
    skeleton, sequence = without(*rows, **options)
    return complete_skeleton(skeleton, sequence, CompleteSkeletonParams(longest=longest))


def test_a_skeleton_of_all_frames_stays_as_it_is() -> None:
    filled = completed()
    assert filled.interpolated == ()
    assert all(getattr(filled, name).tobytes() == getattr(WHOLE, name).tobytes() for name in Skeleton.array_fields())
    assert views.remarks(filled) == ()


def test_missing_frames_are_interpolated_and_measured_ones_stay() -> None:
    first = WHOLE.frames[0]
    filled = completed(3, 6, 7, dropped=(BadFrame(frame=first + 3, reason="the file cannot be read"),))
    assert filled.frames == WHOLE.frames
    rows = [t for t in range(len(WHOLE.frames)) if t not in (3, 6, 7)]
    assert all(getattr(filled, name)[rows].tobytes() == np.array(getattr(WHOLE, name))[rows].tobytes() for name in POSES)
    near = np.linalg.norm(filled.positions - WHOLE.positions, axis=2)[[3, 6, 7]].max()
    apart = np.linalg.norm(np.diff(WHOLE.positions, axis=0), axis=2).max()
    assert 0 < near < apart
    assert filled.confidence[[3, 6, 7]].max() <= 0.25
    assert views.remarks(filled) == (
        f"frame {first + 3}: interpolated, the file cannot be read",
        f"frame {first + 6}: interpolated, no file has its number",
        f"frame {first + 7}: interpolated, no file has its number",
    )


def test_a_long_gap_stays_open() -> None:
    filled = completed(2, 5, 6, 7, longest=2)
    assert [each.frame for each in filled.interpolated] == [WHOLE.frames[2]]
    assert len(filled.frames) == len(WHOLE.frames) - 3


def test_the_file_names_them() -> None:
    filled = completed(4)
    document = json.loads(
        bytes(skeleton_json(filled, plain(filled), UpDirection(up="y", confidence=1.0), unknown_error_bars(filled)).content)
    )
    assert document["interpolated"] == [{"frame": WHOLE.frames[4], "cause": "missing", "reason": ""}]
    assert document["frames"] == list(WHOLE.frames)


def test_every_take_has_files_of_its_own_with_the_same_bones() -> None:
    half = len(WHOLE.frames) // 2
    frames = (*range(half), *(TAKE + 3 + t for t in range(len(WHOLE.frames) - half)))
    skeleton = WHOLE.model_copy(update={"frames": frames})
    sequence = Sequence(frames=frames, fps=None, unit=None, takes=("walk", "run"))
    filled = complete_skeleton(skeleton, sequence, CompleteSkeletonParams())
    assert filled.frames == frames
    bars = bars_of(filled)
    files = skeleton_json(filled, plain(filled), UpDirection(up="y", confidence=1.0), bars)
    assert files.names == ("skeleton-walk.json", "skeleton-run.json")
    walk, run = (json.loads(part) for part in views.files(files, ()).values())
    assert (walk["frames"], run["frames"][0]) == (list(range(half)), 3)
    assert walk["bones"] == run["bones"]
    j = filled.kinds.index("joint")
    assert (walk["errors"][0][j], run["errors"][0][j]) == (
        pytest.approx(bars.in_frame[0, j]),
        pytest.approx(bars.in_frame[half, j]),
    )
    assert walk["positions"] + run["positions"] == WHOLE.positions.tolist()
