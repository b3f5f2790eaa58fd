"""What a run over a data set leaves for Prometheus."""

import json
import sys

import pytest
from pipeline.lab import Lab

from kinetree.errors import ConfigError

parser = pytest.importorskip("prometheus_client.parser", reason="prometheus-client writes metrics")


@pytest.fixture
def lab(toys):
    return Lab.of(toys).write(metrics="metrics/lab.prom")


def rows(lab):
    """Every row of the file: name and labels but that of the data set, and value."""
    text = (lab.file.parent / "metrics" / "lab.prom").read_text()
    samples = [sample for family in parser.text_string_to_metric_families(text) for sample in family.samples]
    assert {sample.labels["data_set"] for sample in samples} == {"lab.yaml"}
    return {(s.name, *(v for k, v in sorted(s.labels.items()) if k != "data_set")): s.value for s in samples}


def test_a_run_tells_what_it_did(lab):
    record = lab.run()
    metrics = rows(lab)
    assert record["metrics"] == str(lab.file.parent / "metrics" / "lab.prom")
    assert metrics["toy_dataset_success",] == 1
    assert metrics["toy_dataset_sequences", "ran"] == 3
    assert metrics["toy_dataset_nodes", "ran", "points"] == 7
    assert metrics["toy_dataset_node_seconds", "points"] > 0
    assert metrics["toy_dataset_duration_seconds",] == record["seconds"]
    assert not [row for row in metrics if row[0] == "toy_dataset_sequence_failed"]


def test_a_second_run_replaces_them(lab):
    lab.run()
    lab.toys.flag("fail-points-500")
    lab.take("b", 30, 40, 500)
    lab.run()
    metrics = rows(lab)
    assert metrics["toy_dataset_success",] == 0
    assert metrics["toy_dataset_sequence_failed", "b"] == 1
    assert (metrics["toy_dataset_sequences", "fresh"], metrics["toy_dataset_sequences", "failed"]) == (2, 1)
    assert sum(value for row, value in metrics.items() if row[0] == "toy_dataset_nodes" and row[1] == "failed") == 1


def test_a_run_that_stops_leaves_them_too(lab, monkeypatch):
    lab.run()
    monkeypatch.setattr("kinetree.pipeline.dataset.dataset.Workers.run", _interrupted)
    lab.take("d", 80, 90)
    with pytest.raises(KeyboardInterrupt):
        lab.run()
    assert rows(lab)["toy_dataset_success",] == 0


def _interrupted(*_):
    raise KeyboardInterrupt


def test_a_place_that_cannot_be_written_is_told_and_costs_no_result(lab):
    (lab.file.parent / "metrics").write_text("a file")
    record = lab.run()
    assert record["status"] == "done"
    assert "lab.prom: cannot be written: File exists" in record["metrics_error"]
    assert json.loads((lab.results / "dataset.json").read_text())["metrics_error"] == record["metrics_error"]


def test_without_the_package_the_run_is_refused_before_anything_is_computed(lab, monkeypatch):
    monkeypatch.setitem(sys.modules, "prometheus_client", None)
    with pytest.raises(ConfigError, match=r"pip install 'kinetree\[metrics\]', or remove the key metrics"):
        lab.run()
    assert lab.toys.executions() == []


def test_what_is_no_path_is_refused(lab):
    for wrong in (3, "", "http://gateway:9091"):
        with pytest.raises(ConfigError, match=r"metrics: expected the path of a file"):
            lab.write(metrics=wrong).dataset()
