"""The command: two runs in, tables, JSON or a page out, and refusals in words."""

import errno
import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
from click.testing import Result
from results import comparison_graphs
from results.true_skeletons import generated, written_truth
from typer.testing import CliRunner

from kinetree.errors import ConfigError, InputError, UnknownNodeError
from kinetree.pipeline import application
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.storage.place import Folder
from kinetree.schemas.results.evaluation import Evaluation, JointScore
from kinetree.tasks import compare as compare_module
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.commands.compare import compare as command
from kinetree.tasks.compare import compare, labelled

METHODS = {"mesoscopic": comparison_graphs.WHOLE, "one-armed": comparison_graphs.ONE_ARMED}
SYNTH = {"figure": "human", "frames": 4, "vertices": 600, "connectivity": "fixed"}


@pytest.fixture(autouse=True)
def _methods(monkeypatch: pytest.MonkeyPatch) -> None:
    known = replace(APPLICATION, methods=lambda: METHODS)
    monkeypatch.setattr(application, "_installed", lambda: known)


def computed(out: Path, method: str, **blocks: Any) -> str:
    config = {"output": str(out), "method": method, "source": {"synth": SYNTH}, "compute": {"executor": "sync"}, **blocks}
    summary = Pipeline.of(config, methods=METHODS).run()
    assert summary["status"] == "done", summary["failures"]
    return str(out)


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    folder = tmp_path_factory.mktemp("runs")
    return computed(folder / "whole", "mesoscopic"), computed(folder / "armless", "one-armed", mesh={"merge": 1e-6})


def asked(*words: object) -> Result:
    app = typer.Typer()
    app.command()(command)
    return CliRunner().invoke(app, [str(word) for word in words])


def refused(*words: object) -> Exception:
    result = asked(*words)
    assert isinstance(result.exception, Exception), result.output
    return result.exception


def test_tables_say_what_each_run_found_and_in_what_they_differ(runs: tuple[str, str]) -> None:
    result = asked(*runs)
    assert result.exit_code == 0, result.exception
    rows = {line.split("  ")[0]: line.split() for line in result.output.splitlines()}
    scored = rows["joints found"][-1]
    assert rows["joints found"][2:] == [scored, "of", scored, str(int(scored) - 1), "of", scored]
    assert rows["frames"][1:] == ["4", "4"]
    assert rows["method"][1:] == ["mesoscopic", "one-armed"]
    assert rows["mesh.merge"][1:] == ["1e-07", "1e-06"]
    assert "true joints found by A alone: shoulder_r" in result.output
    assert "only in A: shoulder_r (nearest" in result.output
    assert "only in B" not in result.output
    assert "each is the nearest of its kind to the other" in result.output


def test_python_gives_the_same_as_json(runs: tuple[str, str]) -> None:
    comparison = compare(*runs)
    content = json.loads(asked(*runs, "--json").output)
    assert content["format"] == "kinetree.comparison/1"
    assert [joint["name"] for joint in content["only_a"]] == [joint.name for joint in comparison.only_a]
    assert [joint.name for joint in comparison.only_a] == list(comparison_graphs.LIMB)
    assert comparison.only_b == ()
    assert comparison.mean_percent == pytest.approx(0.0)
    assert len(content["distance"]) == 4


def test_exchanged_runs_exchange_the_result(runs: tuple[str, str]) -> None:
    one, two = compare(*runs), compare(*reversed(runs))
    assert one.only_a == two.only_b
    assert [(p.a, p.b) for p in one.pairs] == [(p.b, p.a) for p in two.pairs]
    assert (one.a.found, one.b.found) == (two.b.found, two.a.found)


def test_what_cannot_be_kept_is_told_beside_the_result(
    runs: tuple[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: Folder) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    (tmp_path / "truth.json").write_text(written_truth(generated(frames=4)))
    monkeypatch.setattr(Folder, "_beside", refuse)
    result = asked(*runs, "--truth", tmp_path / "truth.json", "--json")
    assert json.loads(result.stdout)["truth"] == "truth.json"
    assert [line.partition("; computed")[2] for line in result.stderr.splitlines()] == [" in memory, nothing is kept"] * 2


def test_truth_that_is_named_judges_both(runs: tuple[str, str], tmp_path: Path) -> None:
    content = json.loads(written_truth(generated(frames=4)))
    content["positions"] = [[[x + 0.02 * content["height"], y, z] for x, y, z in frame] for frame in content["positions"]]
    (tmp_path / "truth.json").write_text(json.dumps(content))
    comparison = compare(*runs, tmp_path / "truth.json")
    assert comparison.truth == "truth.json"
    assert (comparison.a.percent, comparison.b.percent) == (pytest.approx(2.0), pytest.approx(2.0))
    content["positions"] = [[[1e7, 0, 0]] * len(content["joints"])] * 4
    (tmp_path / "truth.json").write_text(json.dumps(content))
    error = refused(*runs, "--truth", tmp_path / "truth.json")
    assert isinstance(error, InputError)
    assert "truth of another sequence" in str(error)


def test_page_is_whole_and_asks_for_nothing(runs: tuple[str, str], tmp_path: Path) -> None:
    path = tmp_path / "ab.html"
    result = asked(*runs, "-o", path)
    assert result.exit_code == 0, result.exception
    text = path.read_text()
    assert "{{" not in text.partition('<script type="application/json"')[0]
    assert text.count('data-row="') == len(json.loads(text.split('id="comparison">')[1].partition("</script>")[0])["rows"])
    assert "default-src 'none'" in text
    assert list(tmp_path.iterdir()) == [path]


def test_what_cannot_be_compared_is_refused_in_words(runs: tuple[str, str], tmp_path: Path) -> None:
    same = refused(runs[0], runs[0])
    assert isinstance(same, ConfigError)
    assert "are the same run" in str(same)
    assert "ends in .html" in str(refused(*runs, "-o", tmp_path / "page.pdf"))
    config = tmp_path / "own.yaml"
    config.write_text(json.dumps({"output": str(tmp_path / "own"), "source": {"synth": SYNTH}}))
    unfinished = refused(runs[0], config)
    assert isinstance(unfinished, UnknownNodeError)
    assert str(unfinished).startswith(f"{config} is not finished, or ")
    assert str(unfinished).endswith(f"; kinetree run {config} computes what is missing")
    fewer = computed(tmp_path / "fewer", "mesoscopic", source={"synth": {**SYNTH, "frames": 3}})
    assert "has 4 frames, 0 to 3 and" in str(refused(runs[0], fewer))
    assert "compute one of them again with --frames" in str(refused(runs[0], fewer))
    finer = computed(tmp_path / "finer", "mesoscopic", source={"synth": {**SYNTH, "vertices": 700}})
    assert "they are not runs of the same sequence" in str(refused(runs[0], finer))


def test_found_joints_are_called_as_people_call_them_and_the_truth_keeps_its_names() -> None:
    joints = (JointScore(name="knee_l", found="limb_a_2"), JointScore(name="hip_l"))
    evaluation = Evaluation(
        truth="t", frames=(0,), true_frames=1, unit=None, height=1.0, joints=joints, spurious=("limb_b_1", "root"),
        duplicate_of=("knee_l", ""), summary=None, error=np.zeros((1, 2)), detection=np.zeros(1), distance=np.zeros(1),
    )  # fmt: skip
    named = labelled(evaluation, {"limb_a_2": "left knee", "limb_b_1": "left elbow", "knee_l": "wrong"})
    assert [(joint.name, joint.found) for joint in named.joints] == [("knee_l", "left knee"), ("hip_l", None)]
    assert named.spurious == ("left elbow", "root")
    assert named.duplicate_of == ("knee_l", "")


def test_runs_that_know_what_joints_are_called_are_compared_in_these_names(
    runs: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compare_module, "_labels", lambda there: {"shoulder_r": "right shoulder", "elbow_r": "right elbow"})
    result = asked(*runs)
    assert "only in A: right shoulder (nearest" in result.output
    assert "true joints found by A alone: shoulder_r" in result.output
