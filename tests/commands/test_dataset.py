"""`kinetree dataset` with the graph of kinetree: what sequences left in the store becomes one page; nothing of them runs."""

import csv
import json

import numpy as np
import pytest
from results.rigged_bodies import spider
from results.sequence_tables import evaluated, judged

from kinetree.errors import ConfigError
from kinetree.pipeline.command_line.cli import command_line
from kinetree.pipeline.dataset.dataset import Dataset
from kinetree.pipeline.output.outcome import Outcome
from kinetree.pipeline.output.ownership import MARKER
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.results.evaluation import Summary
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.application import APPLICATION


@pytest.fixture
def lab(tmp_path):
    """Two takes, one with a truth; the first was computed, the second failed."""
    for name in ("walk", "dance"):
        (tmp_path / "takes" / name).mkdir(parents=True)
    (tmp_path / "takes" / "walk" / "truth.json").write_text("{}")
    keys = {"sequences": "takes/*", "output": "results/{name}", "truth": {"file": "{input}/truth.json"}}
    (tmp_path / "lab.yaml").write_text(json.dumps(keys))
    data_set = Dataset.of(tmp_path / "lab.yaml", application=APPLICATION)
    body = spider()
    zero = np.zeros(len(body.frames))
    sure = FrameConfidence(frames=body.frames, residual=zero, uncovered=zero, unreliable=zero, inlier=zero == 0)
    data_set.store.create()
    artifacts = {"skeleton": body, "evaluation": evaluated(Summary(scored=2, found=1)), "frame_confidence": sure}
    artifacts["up_direction"] = UpDirection(up="z", confidence=1.0)
    artifacts["verdict"] = judged(body)
    digests = {name: data_set.store.publish(artifact)[0] for name, artifact in artifacts.items()}
    walk = Outcome("walk", "", "done", "2026-01-01", "run", 3.0, 12, artifacts=digests, files={"report.html": (1, 1)})
    walk.write(data_set["walk"].config.output)
    why = {"node": "mesh[frame=3]", "error": "MeshError", "message": "torn"}
    Outcome("dance", "", "failed", "2026-01-01", failures=(why,)).write(data_set["dance"].config.output)
    return data_set


def test_the_page_is_made_of_what_lies_in_the_store(lab):
    told = lab.report()
    assert told["status"] == "done"
    folder = lab.config.root
    rows = list(csv.DictReader((folder / "summary.csv").read_text().splitlines()))
    assert [(row["name"], row["status"], row["joints"]) for row in rows] == [("dance", "failed", ""), ("walk", "done", "2")]
    assert [row["verdict"] for row in rows] == ["", "except"]
    page = (folder / "index.html").read_text()
    assert "good except for left &lt;shoulder&gt;</span>" in page
    assert '<a href="walk/report.html">walk</a>' in page
    assert "mesh[frame=3]: MeshError: torn" in page
    assert [row["frames"] for row in lab.table()] == [None, 12]


def test_nothing_of_a_single_sequence_is_left_above_all(lab):
    assert lab.report()["status"] == "done"
    own = {"index.html", "summary.csv", "summary.json", "outcome.json", "store", "walk", "dance"}
    assert {path.name for path in lab.config.root.iterdir() if path.name != MARKER} == own


def test_the_page_is_not_made_again_while_nothing_changed(lab):
    lab.report()
    before = (lab.config.root / "index.html").stat().st_mtime_ns
    lab.report()
    assert (lab.config.root / "index.html").stat().st_mtime_ns == before


def test_a_truth_is_read_where_there_is_one(lab):
    assert lab["walk"].config.params["truth"].file == f"{lab.config.inputs['walk']}/truth.json"
    assert lab["dance"].config.params["truth"].file == ""
    assert lab.config.notes == ("{input}/truth.json: there is none for dance",)


def test_the_command_prints_the_plan_and_the_status(lab, capsys):
    for action, words in (("plan", "refused"), ("status", "mesh[frame=3] torn")):
        with APPLICATION.active():
            command_line(APPLICATION)(["dataset", action, lab.config.file], standalone_mode=False)
        assert words in capsys.readouterr().out


def test_the_block_sequence_is_not_taken_for_the_key_sequences(tmp_path):
    (tmp_path / "lab.yaml").write_text("sequence: takes/*")
    with pytest.raises(ConfigError, match="sequences is missing: say which there are; did you mean it by 'sequence'?"):
        Dataset.of(tmp_path / "lab.yaml", application=APPLICATION)
    (tmp_path / "lab.yaml").write_text("sequence: {fps: 25}")
    with pytest.raises(ConfigError, match="sequences is missing: say which there are, e"):
        Dataset.of(tmp_path / "lab.yaml", application=APPLICATION)
