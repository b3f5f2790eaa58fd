"""Step II from end to end: a body aligned to all frames, on good input and on bad, with any number of workers."""

from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from kinetree.pipeline import Pipeline
from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.registration.stiffness import PASSES

STEP_TWO = ("projection", "frame_confidence")
COARSE = {"geodesics": {"bases": 40}, "deformation_graph": {"nodes": 120}}
NEAR = 0.01  # of the body's size: twice what a surface of so few vertices leaves
HUMAN = {"figure": "human", "frames": 5, "vertices": 1200}


def ran(folder: Path, executor: str = "sync", workers: int = 1, **blocks: Any) -> tuple[Pipeline, dict[str, Any]]:
    compute = {"executor": executor, "workers": workers}
    pipeline = Pipeline.of({"output": str(folder), "compute": compute, **COARSE, **blocks})
    return pipeline, pipeline.run(until=STEP_TWO)


def digests(pipeline: Pipeline, task: str) -> list[str]:
    return [str(entry.artifact) for node, entry in pipeline.schedule(until=STEP_TWO).entries.items() if node.task == task]


def changed(tmp_path: Path, name: str, frame: int, change: Any, **params: Any) -> dict[str, Any]:
    """A generated sequence as files, one frame of it changed."""
    generated = body(recipe(SynthParams(**{**HUMAN, **params})))
    folder = tmp_path / name
    folder.mkdir()
    for t in range(len(generated.X)):
        mesh = trimesh.Trimesh(*generated.frame(t), process=False)
        (change(mesh) if t == frame else mesh).export(folder / f"frame_{t}.ply")
    return {"input": str(folder)}


def said(pipeline: Pipeline) -> str:
    return "\n".join(f"{node}: {text}" for node, text in pipeline.remarks())


def far(pipeline: Pipeline, t: int) -> float:
    """Mean distance of the aligned body to a frame, share of its size."""
    here, reference = pipeline.artifact("alignment", frame=t), pipeline.artifact("reference")
    return float(here.residual.mean() / reference.size)  # type: ignore[attr-defined]


def test_alignment_is_the_same_bit_for_bit_for_any_number_of_workers(tmp_path: Path) -> None:
    alone, account = ran(tmp_path / "alone", source={"synth": HUMAN})
    assert account["status"] == "done"
    assert max(far(alone, t) for t in range(5)) < NEAR
    several, _ = ran(tmp_path / "several", "threads", 4, source={"synth": HUMAN})
    for task in ("tracking", "recovery", "stiffness", "refit", "roll", "alignment", "projection", "frame_confidence"):
        assert digests(alone, task) == digests(several, task), task


def test_fixed_connectivity_is_aligned_already(tmp_path: Path) -> None:
    pipeline, account = ran(tmp_path, source={"synth": {**HUMAN, "frames": 3, "connectivity": "fixed"}})
    assert account["status"] == "done"
    for t in range(3):
        here, mesh = pipeline.artifact("alignment", frame=t), pipeline.artifact("mesh", frame=t)
        assert np.array_equal(here.vertices, mesh.vertices)  # type: ignore[attr-defined]
    assert pipeline.artifact("deformation_graph").nodes.size == 0  # type: ignore[attr-defined]
    tasks = {node.task for node in pipeline.schedule(until=STEP_TWO).entries}
    assert not {"stiffness", "refit", "roll_candidates", "roll"} & tasks, "without passes they have no nodes"


def test_every_pass_has_its_nodes(tmp_path: Path) -> None:
    pipeline, account = ran(tmp_path, source={"synth": {**HUMAN, "frames": 2}})
    assert account["status"] == "done"
    tasks = [node.task for node in pipeline.schedule(until=STEP_TWO).entries]
    assert (tasks.count("stiffness"), tasks.count("roll")) == (len(PASSES), len(PASSES))
    assert (tasks.count("refit"), tasks.count("roll_candidates")) == (2 * len(PASSES), 2), "one pass searches for lost roll"


def test_two_frames_are_aligned(tmp_path: Path) -> None:
    pipeline, account = ran(tmp_path, source={"synth": {**HUMAN, "frames": 2}})
    assert account["status"] == "done"
    assert max(far(pipeline, t) for t in range(2)) < NEAR


def test_ball_without_limbs_is_aligned_and_the_run_says_what_is_amiss(tmp_path: Path) -> None:
    (tmp_path / "scans").mkdir()
    for t in range(3):
        ball = trimesh.creation.icosphere(subdivisions=3, radius=1 + t / 20).subdivide_loop(0)
        ball.faces = np.roll(ball.faces, t, axis=0)
        ball.export(tmp_path / "scans" / f"{t}.ply")
    pipeline, account = ran(tmp_path / "out", source={"input": str(tmp_path / "scans")})
    assert account["status"] == "done"
    assert not pipeline.artifact("reference").fixed  # type: ignore[attr-defined]
    assert "reference: no limb found in any frame" in said(pipeline)
    assert max(far(pipeline, t) for t in range(3)) < NEAR


def test_limb_cut_off_in_some_frames_is_told_and_doubted_there_alone(tmp_path: Path) -> None:
    lost = {"limb": "elbow_r", "begin": 3, "end": 4}
    pipeline, account = ran(tmp_path, source={"synth": {**HUMAN, "dropped": [lost]}})
    assert account["status"] == "done"
    assert "frame_confidence: alignment partly unreliable in frames 3–4: up to" in said(pipeline)
    assert far(pipeline, 1) < NEAR


def test_frame_that_no_pose_fits_is_an_outlier_and_the_frames_around_it_are_none(tmp_path: Path) -> None:
    source = changed(tmp_path, "squashed", 4, lambda mesh: mesh.copy().apply_scale([1.0, 1.0, 0.5]))
    pipeline, account = ran(tmp_path / "out", source=source)
    assert account["status"] == "done"
    confidence = pipeline.artifact("frame_confidence")
    assert confidence.inlier.tolist() == [True, True, True, True, False]  # type: ignore[attr-defined]
    assert pipeline.artifact("alignment", frame=4).confidence.mean() < 0.3  # type: ignore[attr-defined]
    assert "alignment failed in frame 4" in said(pipeline)
    assert max(far(pipeline, t) for t in range(4)) < NEAR


def test_teleported_body_is_found_where_it_holds_its_limbs_as_in_another_frame(tmp_path: Path) -> None:
    def teleported(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
        turn = trimesh.transformations.rotation_matrix(np.pi / 2, [0, 0, 1])
        return mesh.copy().apply_transform(turn).apply_translation([0.4 * mesh.scale] * 3)

    source = changed(tmp_path, "teleport", 4, teleported)
    pipeline, account = ran(tmp_path / "out", source=source)
    assert account["status"] == "done"
    recovery = pipeline.artifact("recovery")
    assert np.flatnonzero(recovery.failed).tolist() == [4]  # type: ignore[attr-defined]
    assert recovery.recovered.tolist() == [4]  # type: ignore[attr-defined]
    assert pipeline.artifact("frame_confidence").inlier.all()  # type: ignore[attr-defined]
    assert max(far(pipeline, t) for t in range(5)) < NEAR


def test_frame_with_a_tenth_of_the_vertices_is_aligned_as_well_as_it_is_sampled(tmp_path: Path) -> None:
    fine = {"frames": 3, "vertices": 6000}

    def coarse(_: trimesh.Trimesh) -> trimesh.Trimesh:
        return trimesh.Trimesh(*body(recipe(SynthParams(**{**HUMAN, "vertices": 600}))).frame(2), process=False)

    pipeline, account = ran(tmp_path / "out", source=changed(tmp_path, "coarse", 2, coarse, **fine))
    assert account["status"] == "done"
    assert len(pipeline.artifact("mesh", frame=2).vertices) < 600  # type: ignore[attr-defined]
    assert far(pipeline, 2) < NEAR
    assert max(far(pipeline, t) for t in (0, 1)) < NEAR


def test_limbs_that_meet_do_not_swap(tmp_path: Path) -> None:
    touch = {"limb": "hand_r", "target": "hip_r", "begin": 4, "end": 5, "ramp": 3}
    synth = {**HUMAN, "frames": 9, "contacts": [touch]}
    pipeline, account = ran(tmp_path, source={"synth": synth})
    assert account["status"] == "done"
    generated, reference = body(recipe(SynthParams(**synth))), pipeline.artifact("reference")
    start: int = reference.frame  # type: ignore[attr-defined]
    assert start not in (4, 5)
    hand = generated.figure.index("hand_r", "")
    near = np.linalg.norm(reference.vertices - generated.X[start, hand], axis=1) < 0.05 * generated.figure.height  # type: ignore[attr-defined]
    for t in range(9):
        here = pipeline.artifact("alignment", frame=t)
        away = np.linalg.norm(here.vertices[near].mean(axis=0) - generated.X[t, hand])  # type: ignore[attr-defined]
        assert away < 0.1 * generated.figure.height, "hands are half a height apart"
