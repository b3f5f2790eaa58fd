"""The 2009 paper from end to end: from meshes to a tree of joints, and what becomes of it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kinetree.pipeline import Pipeline

HUMAN = {"figure": "human", "frames": 3, "vertices": 500}


def ran(output: Path, **blocks: Any) -> Pipeline:
    pipeline = Pipeline.of({"output": str(output), "source": {"synth": HUMAN}, "compute": {"executor": "sync"}, **blocks})
    assert pipeline.run()["status"] == "done"
    return pipeline


@pytest.fixture(scope="module")
def human(tmp_path_factory: pytest.TempPathFactory) -> Pipeline:
    return ran(tmp_path_factory.mktemp("human"), method="reeb", geodesics={"bases": 30})


def test_human_becomes_one_tree_with_a_pose_in_every_frame(human: Pipeline) -> None:
    skeleton: Any = human.artifact("skeleton")
    assert skeleton.frames == tuple(range(3))
    assert 5 <= skeleton.kinds.count("leaf") <= 7, "head, hands and feet, and heels where so few vertices show them"
    assert skeleton.kinds.count("joint") >= 2
    assert np.isfinite(skeleton.positions).all()
    summary: Any = human.artifact("evaluation").summary
    assert summary.found + summary.tips_found >= 3


def test_second_run_runs_nothing(human: Pipeline) -> None:
    assert sum(count["ran"] for count in human.run()["tasks"].values()) == 0


def test_exports_are_those_of_every_method(human: Pipeline) -> None:
    out = Path(human.config.output)
    assert json.loads((out / "skeleton.json").read_text())["format"] == "kinetree.skeleton/2"
    for name in ("skeleton.glb", "skeleton.bvh", "evaluation.json"):
        assert (out / name).is_file()
    assert (out / "segmentation.zarr").is_dir()
    page = (out / "report.html").read_text()
    for anchor in ("structure", "truth", "graphs", "clusters", "intervals", "alignment", "run"):
        assert f'<section id="{anchor}">' in page


def test_preset_of_the_paper_reaches_the_end(tmp_path: Path) -> None:
    preset = ran(tmp_path, extends="paper-2009", geodesics={"sum": "bases", "bases": 30})
    skeleton: Any = preset.artifact("skeleton")
    assert skeleton.frames == tuple(range(3))
    assert np.isfinite(skeleton.positions).all()
    assert (tmp_path / "report.html").is_file()
