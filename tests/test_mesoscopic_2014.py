"""The 2014 paper from end to end: from meshes to a tree of joints, and what becomes of it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from kinetree.pipeline import Pipeline
from kinetree.tasks.results.plots.mesoscopic import cones as drawn_cones
from kinetree.tasks.results.plots.mesoscopic import lengths, merging, structure

TOUCH = {"limb": "hand_r", "target": "hip_r", "begin": 5, "end": 9}
HUMAN = {"figure": "human", "frames": 13, "vertices": 1000, "contacts": [TOUCH]}
DOG = {"figure": "quadruped", "frames": 4, "vertices": 500}


def ran(output: Path, executor: str = "sync", **blocks: Any) -> Pipeline:
    given = {"method": "mesoscopic-2014", "output": str(output), "compute": {"executor": executor}, **blocks}
    pipeline = Pipeline.of(given)
    assert pipeline.run()["status"] == "done"
    return pipeline


@pytest.fixture(scope="module")
def human(tmp_path_factory: pytest.TempPathFactory) -> Pipeline:
    return ran(tmp_path_factory.mktemp("human"), source={"synth": HUMAN}, geodesics={"bases": 30})


def test_human_whose_hand_touches_the_hip_becomes_one_tree_with_a_pose_in_every_frame(human: Pipeline) -> None:
    skeleton: Any = human.artifact("kinematic_structure")
    assert skeleton.frames == tuple(range(13))
    assert skeleton.kinds.count("leaf") == 5
    assert skeleton.kinds.count("joint") >= 8
    assert np.isfinite(skeleton.positions).all()
    consistent: Any = human.artifact("cone_consistency")
    assert (consistent.leaf < 0).any(), "the hand on the hip has no leaf"
    evaluation: Any = human.artifact("evaluation")
    assert sum(joint.found is not None for joint in evaluation.joints) >= 3


def test_second_run_runs_nothing(human: Pipeline) -> None:
    assert sum(count["ran"] for count in human.run()["tasks"].values()) == 0


def test_exports_are_those_of_every_method(human: Pipeline) -> None:
    out = Path(human.config.output)
    assert json.loads((out / "skeleton.json").read_text())["format"] == "kinetree.skeleton/1"
    assert (out / "skeleton.glb").is_file()
    assert (out / "skeleton.bvh").is_file()
    assert (out / "segmentation.zarr").is_dir()
    page = (out / "report.html").read_text()
    for anchor in ("structure", "truth", "cones", "bones", "intervals", "alignment", "run"):
        assert f'<section id="{anchor}">' in page


def test_pictures_of_cones_merge_errors_and_bones_are_drawn(human: Pipeline, tmp_path: Path) -> None:
    there, named = human.inspect(), {"skeleton": "kinematic_structure"}
    for name, draw in (("cones", drawn_cones), ("merging", merging), ("structure", structure), ("lengths", lengths)):
        figure = draw(lambda task, **index: there.artifact(named.get(task, task), **index), [0, 7])
        figure.savefig(tmp_path / f"{name}.png", dpi=40)
        assert (tmp_path / f"{name}.png").stat().st_size > 5000


def test_preset_of_the_paper_reaches_the_end_and_the_same_whoever_computes_it(tmp_path: Path) -> None:
    one, other = (ran(tmp_path / who, who, extends="paper-2014", source={"synth": DOG}) for who in ("sync", "threads"))
    skeleton: Any = one.artifact("kinematic_structure")
    assert skeleton.frames == (0, 1, 2, 3)
    assert skeleton == other.artifact("kinematic_structure")


def test_ball_becomes_one_rigid_part_and_the_run_says_so(tmp_path: Path) -> None:
    (tmp_path / "scans").mkdir()
    for t in range(2):
        ball = trimesh.creation.icosphere(subdivisions=2).apply_scale(1 + 0.1 * t)
        ball.faces = np.roll(ball.faces, 7 * t, axis=0)
        ball.export(tmp_path / "scans" / f"frame_{t}.ply")
    pipeline = ran(tmp_path / "out", source={"input": str(tmp_path / "scans")}, geodesics={"bases": 20})
    assert any("one rigid part" in text for _, text in pipeline.remarks())
    skeleton: Any = pipeline.artifact("kinematic_structure")
    assert skeleton.kinds == ("root",)
