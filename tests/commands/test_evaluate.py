"""The command: a run and a truth in, a table, JSON or a picture out, and refusals in words."""

import errno
import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import typer
from click.testing import Result
from results import true_skeleton_graph
from results.true_skeletons import generated, written_truth
from typer.testing import CliRunner

from kinetree.errors import ConfigError, InputError, UnknownNodeError
from kinetree.pipeline import application
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.storage.place import Folder
from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.commands.evaluate import evaluate
from kinetree.tasks.input.synth import write_sequence

RECIPE = generated()
SYNTH = {"figure": "human", "frames": 6, "vertices": 600, "connectivity": "fixed"}


@pytest.fixture(autouse=True)
def _methods(monkeypatch: pytest.MonkeyPatch) -> None:
    known = replace(APPLICATION, methods=lambda: {"mesoscopic": true_skeleton_graph.GRAPH})
    monkeypatch.setattr(application, "_installed", lambda: known)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> str:
    out = tmp_path_factory.mktemp("run")
    config = {"output": str(out), "source": {"synth": SYNTH}, "compute": {"executor": "sync"}}
    pipeline = Pipeline.of(config, methods={"mesoscopic": true_skeleton_graph.GRAPH})
    assert pipeline.run()["status"] == "done"
    return str(out)


@pytest.fixture
def truth(tmp_path: Path) -> Path:
    path = tmp_path / "truth.json"
    path.write_text(written_truth(RECIPE))
    return path


def asked(*words: object) -> Result:
    app = typer.Typer()
    app.command()(evaluate)
    return CliRunner().invoke(app, [str(word) for word in words])


def refused(*words: object) -> Exception:
    result = asked(*words)
    assert isinstance(result.exception, Exception), result.output
    return result.exception


def test_run_of_a_generated_sequence_evaluates_itself(run: str) -> None:
    content = json.loads((Path(run) / "evaluation.json").read_text())
    assert content["format"] == "kinetree.evaluation/1"
    assert content["summary"]["found"] == content["summary"]["scored"] > 8
    assert len(content["error"]) == 6
    assert None in content["error"][0]


def test_table_names_every_joint_and_sums_up(run: str, truth: Path) -> None:
    result = asked(run, truth)
    assert result.exit_code == 0, result.exception
    lines = result.output.splitlines()
    assert any(line.split()[:4] == ["knee_l", line.split()[1], "knee_l", line.split()[3]] for line in lines)
    assert "joints found, mean error 0.00 % of the height" in result.output
    assert "tree edit distance 0" in result.output
    assert "CD-J2J" in result.output


def test_json_is_what_a_run_leaves(run: str) -> None:
    assert json.loads(asked(run, "--json").output) == json.loads((Path(run) / "evaluation.json").read_text())


def test_truth_that_is_named_goes_before_the_runs_own(run: str, truth: Path) -> None:
    content = json.loads(truth.read_text())
    content["positions"] = [[[x + 0.03 * content["height"], y, z] for x, y, z in frame] for frame in content["positions"]]
    truth.write_text(json.dumps(content))
    result: dict[str, Any] = json.loads(asked(run, truth, "--json").output)
    assert result["truth"] == "truth.json"
    assert result["summary"]["percent"] == pytest.approx(3.0)


def test_what_cannot_be_kept_is_told_beside_the_result(run: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: Folder) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(Folder, "_beside", refuse)
    result = asked(run, "--json", "--set", "evaluation.found=0.2")
    assert json.loads(result.stdout)["summary"]["found"] > 8
    assert result.stderr.startswith(f"store {run}/store: cannot write ")
    assert result.stderr.endswith("; computed in memory, nothing is kept\n")
    assert asked(run, "--json").stderr == ""


def test_limit_can_be_set(run: str, truth: Path) -> None:
    content = json.loads(truth.read_text())
    content["positions"] = [[[x + 0.07 * content["height"], y, z] for x, y, z in frame] for frame in content["positions"]]
    truth.write_text(json.dumps(content))
    assert json.loads(asked(run, truth, "--json").output)["summary"]["found"] == 0
    wider = json.loads(asked(run, truth, "--json", "--set", "evaluation.found=0.1").output)["summary"]
    assert wider["found"] == wider["scored"]


@pytest.mark.parametrize("ending", [".png", ".svg"])
def test_errors_are_drawn(run: str, truth: Path, tmp_path: Path, ending: str) -> None:
    content = json.loads(truth.read_text())
    content["positions"] = [[[x + 1.5 * t, y, z] for x, y, z in frame] for t, frame in enumerate(content["positions"])]
    content["positions"] = [[*frame[:7], [9e3, 0, 0], *frame[8:]] for frame in content["positions"]]
    truth.write_text(json.dumps(content))
    path = tmp_path / f"errors{ending}"
    result = asked(run, truth, "--plot", path)
    assert result.exit_code == 0, result.exception
    assert path.stat().st_size > 5000
    assert {p.name for p in tmp_path.iterdir()} == {"truth.json", path.name}


def test_what_is_wrong_with_the_truth_is_an_error_of_input(run: str, truth: Path, tmp_path: Path) -> None:
    assert "No such file" in str(refused(run, tmp_path / "nowhere.json"))
    content = json.loads(truth.read_text())
    truth.write_text(json.dumps({**content, "positions": content["positions"][:2]}))
    error = refused(run, truth)
    assert type(error) is InputError
    assert str(error).startswith("truth.json: it has frames 0 to 1, but 4 of the 6 frames of the sequence are missing")
    truth.write_text(json.dumps({**content, "positions": [[[1e7, 0, 0]] * len(content["joints"])] * 6}))
    assert "truth of another sequence" in str(refused(run, truth))


def test_picture_without_a_format_and_run_that_was_not_made_are_refused(run: str, tmp_path: Path) -> None:
    error = refused(run, "--plot", tmp_path / "a.gif")
    assert isinstance(error, ConfigError)
    assert "pictures end in .png, .svg, .pdf" in str(error)
    config = tmp_path / "own.yaml"
    config.write_text(json.dumps({"output": str(tmp_path / "own"), "source": {"synth": SYNTH}}))
    error = refused(config)
    assert isinstance(error, UnknownNodeError)
    assert "kinetree run computes what is missing" in str(error)


def test_folder_of_meshes_has_no_truth_until_one_is_named(tmp_path: Path) -> None:
    write_sequence(SynthParams.model_validate(SYNTH), tmp_path / "walk")
    out = tmp_path / "out"
    config = {"output": str(out), "source": {"input": str(tmp_path / "walk" / "*.ply")}, "compute": {"executor": "sync"}}
    assert Pipeline.of(config).run()["status"] == "done"
    assert not (out / "evaluation.json").exists()
    error = refused(out)
    assert isinstance(error, ConfigError)
    assert "its input came without a true skeleton; name one" in str(error)
    summary = json.loads(asked(out, tmp_path / "walk" / "truth.json", "--json").output)["summary"]
    assert summary["found"] == summary["scored"]
    assert summary["parts"] is None
    assert Pipeline.of(config | {"truth": {"file": str(tmp_path / "walk" / "truth.json")}}).run()["status"] == "done"
    assert json.loads((out / "evaluation.json").read_text())["truth"] == "truth.json"
