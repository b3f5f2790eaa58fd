"""Step I from end to end: from files or a synthetic body to intervals and leaves, on good input and on bad."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from kinetree.pipeline import Pipeline
from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.input.synth.body import Body

STEP_ONE = ("sequence", "connectivity", "leaves")
BALL = trimesh.creation.icosphere(subdivisions=2)


def ran(tmp_path: Path, **blocks: Any) -> tuple[Pipeline, dict[str, Any]]:
    blocks.setdefault("geodesics", {"bases": 50})
    pipeline = Pipeline.of({"output": str(tmp_path / "out"), "compute": {"executor": "sync"}, **blocks})
    return pipeline, pipeline.run(until=STEP_ONE)


def written(tmp_path: Path, *meshes: trimesh.Trimesh) -> dict[str, Any]:
    (tmp_path / "scans").mkdir()
    for t, mesh in enumerate(meshes):
        mesh.export(tmp_path / "scans" / f"frame_{t}.ply")
    return {"input": str(tmp_path / "scans")}


def limbs_swapped(pipeline: Pipeline, generated: Body) -> int:
    """How many times a leaf goes over to another limb's true end."""
    leaves: Any = pipeline.artifact("leaves")
    ends = [n for n, joint in enumerate(generated.truth()["joints"]) if joint["kind"] == "tip" and "heel" not in joint["name"]]
    away = np.linalg.norm(leaves.positions[:, :, None] - generated.X[:, ends][None], axis=3)
    nearest = [row[leaves.rows[i] >= 0].argmin(axis=1) for i, row in enumerate(away)]
    return sum(int((np.diff(row) != 0).sum()) for row in nearest)


def said(pipeline: Pipeline) -> str:
    return "\n".join(f"{node}: {text}" for node, text in pipeline.remarks())


def test_hand_on_the_hip_is_an_interval_of_its_own_and_the_hand_comes_back_as_itself(tmp_path: Path) -> None:
    touch = {"limb": "hand_r", "target": "hip_r", "begin": 8, "end": 16}
    synth = {"figure": "human", "frames": 24, "vertices": 2500, "contacts": [touch]}
    pipeline, account = ran(tmp_path, source={"synth": synth})
    assert account["status"] == "done"
    intervals, leaves = pipeline.artifact("intervals"), pipeline.artifact("leaves")
    assert np.abs(intervals.end[:-1] - [7, 16]).max() <= 2  # type: ignore[attr-defined]
    is_kept = leaves.kept  # type: ignore[attr-defined]
    assert is_kept[0].sum() == is_kept[2].sum() == 5
    assert is_kept[0].tolist() == is_kept[2].tolist()
    assert is_kept[1].sum() == 4, "the elbow of the arm on the hip is no leaf"
    assert limbs_swapped(pipeline, body(recipe(SynthParams(**synth)))) == 0
    assert "leaf" in said(pipeline)
    assert "3 intervals" in said(pipeline)


@pytest.mark.parametrize(("figure", "leaves"), [("quadruped", 6), ("starfish", 5), ("bird", 6), ("snake", 2)])
def test_bodies_that_touch_nothing_are_one_interval_with_all_their_leaves(tmp_path: Path, figure: str, leaves: int) -> None:
    pipeline, _ = ran(tmp_path, source={"synth": {"figure": figure, "frames": 8, "vertices": 2500}})
    assert pipeline.artifact("intervals").cues == ()  # type: ignore[attr-defined]
    assert pipeline.artifact("leaves").kept.sum() == leaves  # type: ignore[attr-defined]


def test_ball_has_no_leaves_and_the_run_says_so(tmp_path: Path) -> None:
    pipeline, account = ran(tmp_path, source=written(tmp_path, BALL, BALL.copy().apply_scale(1.1), BALL))
    assert account["status"] == "done"
    assert "no leaves" in said(pipeline)
    assert "one interval" in said(pipeline)


def test_identical_frames_correlate_fully_and_are_one_interval(tmp_path: Path) -> None:
    box = trimesh.creation.box(extents=[1, 1, 4]).subdivide().subdivide()
    pipeline, account = ran(tmp_path, source=written(tmp_path, box, box, box, box))
    assert account["tasks"]["mesh"]["ran"] == 1, "equal frames are one computation"
    assert pipeline.artifact("correlation").correlation.tolist() == [1.0, 1.0, 1.0]  # type: ignore[attr-defined]
    assert len(pipeline.artifact("intervals").begin) == 1  # type: ignore[attr-defined]
    assert "fixed connectivity" in said(pipeline)


def test_two_frames_are_enough(tmp_path: Path) -> None:
    pipeline, account = ran(tmp_path, source={"synth": {"figure": "human", "frames": 2, "vertices": 1500}})
    assert account["status"] == "done"
    assert pipeline.artifact("leaves").rows.shape == (5, 2)  # type: ignore[attr-defined]


def test_body_in_pieces_fails_its_frame_with_the_shares_and_nothing_else(tmp_path: Path) -> None:
    balls = [BALL.copy().apply_scale(3**-0.5).apply_translation([3 * n, 0, 0]) for n in range(3)]  # of the same area
    pipeline, account = ran(tmp_path, source=written(tmp_path, BALL, trimesh.util.concatenate(balls), BALL))
    assert account["status"] == "failed"
    (failure,) = account["failures"]
    assert failure["node"] == "geodesics[frame=1]"
    assert "33% of the surface's area, 50% are needed" in failure["message"]
    assert pipeline.why("geodesics[frame=2]").state == "fresh"


def test_shell_inside_the_body_changes_nothing(tmp_path: Path) -> None:
    shell = BALL.copy().apply_scale(0.5)
    pipeline, account = ran(tmp_path, source=written(tmp_path, trimesh.util.concatenate([BALL, shell]), BALL))
    assert account["status"] == "done"
    first, second = (pipeline.artifact("geodesics", frame=t) for t in (0, 1))
    assert np.allclose(first.mu, second.mu)  # type: ignore[attr-defined]
    assert pipeline.artifact("mesh", frame=0).cleaning.nested == 1  # type: ignore[attr-defined]


def test_paper_preset_runs_the_letter(tmp_path: Path) -> None:
    synth = {"figure": "human", "frames": 4, "vertices": 700}
    pipeline = Pipeline.of(
        {"extends": "paper-2014", "output": str(tmp_path / "out"), "source": {"synth": synth}, "compute": {"executor": "sync"}}
    )
    assert pipeline.run(until=STEP_ONE)["status"] == "done"
    assert len(pipeline.artifact("geodesics", frame=0).bases) == 0  # type: ignore[attr-defined]
    assert len(pipeline.artifact("geodesics", frame=0).bases) == 0  # type: ignore[attr-defined]
