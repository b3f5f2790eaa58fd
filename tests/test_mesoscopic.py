"""From meshes to a skeleton and all that people take away: found, left, and made again only where something changed."""

import json
from pathlib import Path
from typing import Any

import pytest

from kinetree.pipeline import Pipeline
from kinetree.pipeline.output.ownership import MARKER

LEFT = ("report.html", "skeleton.json", "skeleton.glb", "skeleton.bvh", "segmentation.zarr", "evaluation.json", "run.json",
        "config.yaml", "store")  # fmt: skip
FIXED = {"figure": "human", "frames": 16, "vertices": 1200, "connectivity": "fixed"}
ANEW = {"figure": "human", "frames": 10, "vertices": 1000}


def pipeline_of(output: Path, synth: dict[str, Any], **blocks: Any) -> Pipeline:
    quick = {"geodesics": {"bases": 40}, "excerpt": {"frames": 6, "views": 1}, "compute": {"executor": "sync"}}
    return Pipeline.of({"output": str(output), "source": {"synth": synth}, **quick, **blocks})


@pytest.fixture(scope="module")
def output(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("fixed") / "out"
    assert pipeline_of(out, FIXED).run()["status"] == "done"
    return out


def ran(account: dict[str, Any]) -> set[str]:
    return {name for name, task in account["tasks"].items() if task["ran"]}


def test_most_joints_are_found_and_few_are_invented(output: Path) -> None:
    summary = json.loads((output / "evaluation.json").read_text())["summary"]
    assert summary["found"] >= 0.7 * summary["scored"]
    assert summary["spurious"] <= 3
    assert summary["percent"] < 2.0


def test_everything_of_the_readmes_table_is_left(output: Path) -> None:
    assert sorted(LEFT) == sorted(p.name for p in output.iterdir() if p.name != MARKER)
    table = (Path(__file__).parents[1] / "README.md").read_text()
    assert all(f"| `{name}" in table for name in LEFT)


def test_second_run_runs_nothing_and_touches_nothing(output: Path) -> None:
    before = {p: p.stat().st_mtime_ns for p in output.iterdir() if p.name.startswith(("skeleton", "segmentation"))}
    assert ran(pipeline_of(output, FIXED).run()) == set()
    assert {p: p.stat().st_mtime_ns for p in before} == before


@pytest.mark.parametrize(
    ("block", "alone"),
    [({"report": {"title": "another"}}, {"report"}), ({"glb": {"up": "z"}}, {"glb"})],
    ids=["title", "up"],
)
def test_option_of_one_result_makes_that_result_alone(output: Path, block: dict[str, Any], alone: set[str]) -> None:
    assert ran(pipeline_of(output, FIXED, **block).run()) == alone
    assert ran(pipeline_of(output, FIXED).run()) == set(), "the first result is still in the store"


def test_file_that_was_deleted_or_spoilt_is_back_after_a_run_that_computes_nothing(output: Path) -> None:
    spoilt = output / "skeleton.glb"
    whole = spoilt.read_bytes()
    spoilt.write_bytes(whole[:-1])
    (output / "report.html").unlink()
    assert ran(pipeline_of(output, FIXED).run()) == set()
    assert spoilt.read_bytes() == whole
    assert (output / "report.html").is_file()


def test_body_surfaced_anew_in_every_frame_is_found_too(tmp_path: Path) -> None:
    pipeline = pipeline_of(tmp_path / "out", ANEW)
    assert pipeline.run()["status"] == "done"
    summary: Any = pipeline.artifact("evaluation").summary  # type: ignore[attr-defined]
    assert summary.found >= 0.6 * summary.scored
    assert summary.spurious <= 6
    assert all((tmp_path / "out" / name).exists() for name in LEFT)
