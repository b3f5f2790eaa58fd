"""The 2014 paper from end to end: from meshes to a tree of joints, and what becomes of it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from kinetree.pipeline import Pipeline
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.commands.plot import plot
from kinetree.tasks.results.plots.mesoscopic import cones as drawn_cones
from kinetree.tasks.results.plots.mesoscopic import lengths, merging, structure

TOUCH = {"limb": "hand_r", "target": "hip_r", "begin": 5, "end": 9}
HUMAN = {"figure": "human", "frames": 13, "vertices": 1000, "contacts": [TOUCH]}
DOG = {"figure": "quadruped", "frames": 4, "vertices": 500}


STEP_TWO = ("arap", "cut_correspondence")


def ran(output: Path, executor: str = "sync", until: tuple[str, ...] = (), **blocks: Any) -> Pipeline:
    given = {"method": "mesoscopic-2014", "output": str(output), "compute": {"executor": executor}, **blocks}
    pipeline = Pipeline.of(given)
    assert pipeline.run(until=until)["status"] == "done"
    return pipeline


def artifact(pipeline: Pipeline, node: str, **index: int) -> Any:
    return pipeline.artifact(node, **index)


def written(folder: Path, *meshes: trimesh.Trimesh) -> dict[str, Any]:
    folder.mkdir()
    for t, one in enumerate(meshes):
        one.export(folder / f"frame_{t}.ply")
    return {"input": str(folder)}


@pytest.fixture(scope="module")
def human(tmp_path_factory: pytest.TempPathFactory) -> Pipeline:
    return ran(tmp_path_factory.mktemp("human"), source={"synth": HUMAN}, geodesics={"bases": 30})


def test_each_interval_has_one_mesh_that_follows_the_body_whoever_computes_it(human: Pipeline, tmp_path: Path) -> None:
    other = ran(tmp_path, "threads", STEP_TWO, source={"synth": HUMAN}, geodesics={"bases": 30})
    cuts = artifact(human, "intervals")
    assert len(cuts.begin) == 3
    for i in range(3):
        reference = artifact(human, "interval_reference", interval=i)
        assert len(reference.leaf) == (5, 4, 5)[i]
        for t in reference.frames:
            here = artifact(human, "arap", interval=i, frame=t)
            assert len(here.vertices) == len(reference.vertices)
            assert here.residual.mean() < 0.03 * reference.size
            assert here == artifact(other, "arap", interval=i, frame=t)
    across = artifact(human, "cut_correspondence")
    assert across.surplus(0, at_end=True), "the hand on the hip has no leaf behind the cut"
    assert across == artifact(other, "cut_correspondence")


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
    assert json.loads((out / "skeleton.json").read_text())["format"] == "kinetree.skeleton/2"
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


def test_ball_is_followed_by_nothing_and_becomes_one_rigid_part_and_the_run_says_so(tmp_path: Path) -> None:
    balls = [trimesh.creation.icosphere(subdivisions=2).apply_scale(1 + 0.1 * t) for t in range(2)]
    balls[1].faces = np.roll(balls[1].faces, 7, axis=0)
    pipeline = ran(tmp_path / "out", source=written(tmp_path / "scans", *balls), geodesics={"bases": 20})
    assert (artifact(pipeline, "geodesic_mapping", interval=0, frame=1).image == -1).all()
    assert artifact(pipeline, "arap", interval=0, frame=1).uncovered > 0.9
    remarks = [text for _, text in pipeline.remarks()]
    assert any("interval 0 has no leaf" in text for text in remarks)
    assert any("one rigid part" in text for text in remarks)
    assert artifact(pipeline, "kinematic_structure").kinds == ("root",)


def test_tracked_vertices_pass_unchanged(tmp_path: Path) -> None:
    boxes = [trimesh.creation.box(extents=[1, 1, 4 + t]).subdivide().subdivide() for t in range(3)]
    scans = written(tmp_path / "scans", *boxes)
    pipeline = ran(tmp_path / "out", until=STEP_TWO, source=scans, geodesics={"bases": 20})
    for t in range(3):
        here = artifact(pipeline, "arap", interval=0, frame=t)
        np.testing.assert_array_equal(here.vertices, artifact(pipeline, "mesh", frame=t).vertices)
        assert (here.confidence == 1.0).all()


def test_on_the_defaults_alignment_a_run_goes_through_and_its_steps_are_drawn(tmp_path: Path) -> None:
    blocks = {"method": "mesoscopic-2014-aligned", "extends": "paper-2014-aligned", "geodesics": {"bases": 30}}
    pipeline = ran(tmp_path / "out", **blocks, source={"synth": {**DOG, "vertices": 700}})
    skeleton, reference = artifact(pipeline, "kinematic_structure"), artifact(pipeline, "reference")
    np.testing.assert_array_equal(skeleton.vertices, reference.vertices)
    assert len(skeleton.frames) == DOG["frames"]
    with APPLICATION.active():
        for what in ("cones", "structure"):
            plot(str(tmp_path / "out"), what, output=tmp_path / f"{what}.png", frames="", up=None)
            assert (tmp_path / f"{what}.png").read_bytes().startswith(b"\x89PNG")
