"""What a run with nothing to do costs, counted: what it asks of the store, what it works out, what it imports."""

import json
import os
from collections import Counter

import pytest

from kinetree.pipeline.identity import key
from kinetree.pipeline.planning import freshness
from kinetree.pipeline.storage import files
from kinetree.pipeline.storage.place import Folder

QUESTIONS = ("get", "tail", "part", "put", "names", "listed", "modified", "remove", "size")
ALONE = {"intervals": {"length": 1000}}
"""One interval, so that the nodes that are not of single frames are as many for every number of frames."""


@pytest.fixture
def asked(monkeypatch):
    """How often the store was asked each question, and a node's key was worked out."""
    monkeypatch.setattr(files, "SETTLED_SECONDS", -1.0)  # digests are kept at once, however long a run takes
    counts = Counter()

    def counted(place, name):
        plain = getattr(place, name)

        def count(*arguments, **named):
            counts[name] += 1
            return plain(*arguments, **named)

        monkeypatch.setattr(place, name, count)

    for question in QUESTIONS:
        counted(Folder, question)
    counted(freshness, "node_key")
    return counts


def test_reads_and_writes_do_not_grow_with_the_frames_and_a_node_is_asked_for_once(toys, asked, tmp_path):
    assert freshness.node_key is not key.node_key, "it is counted"
    costs = []
    for frames in (20, 60):
        toys.write(*(10.0 * (n + 1) for n in range(frames)))
        blocks = {**ALONE, "output": str(tmp_path / f"{frames}")}
        toys.run(**blocks)
        asked.clear()
        nothing = toys.run(**blocks)
        assert not nothing.ran
        costs.append((asked.copy(), nothing.told["nodes"]["fresh"]))
    (few, _), (many, nodes) = costs
    per_node = {"size", "node_key"}
    assert {name: n for name, n in few.items() if name not in per_node} == {
        name: n for name, n in many.items() if name not in per_node
    }
    assert many["node_key"] == nodes
    assert many["size"] <= nodes + 5


def test_what_lists_members_is_asked_for_them_once_however_many_frames_there_are(toys, monkeypatch, tmp_path):
    questions = []
    intervals = toys.module.Intervals
    plain = intervals.members
    monkeypatch.setattr(intervals, "members", lambda *asked: questions.append(asked[1:]) or plain(*asked))
    counts = []
    for frames in (5, 40):
        toys.write(*(10.0 * (n + 1) for n in range(frames)))
        blocks = {**ALONE, "output": str(tmp_path / f"{frames}")}
        toys.run(**blocks)
        questions.clear()
        assert not toys.run(**blocks).ran
        counts.append(sorted(questions))
    assert counts[0] == counts[1] == [("interval", ()), ("interval/frame", (0,))]


def test_libraries_that_compute_and_store_are_not_imported(toys):
    config = str(toys.yaml())
    assert toys.command("run", config, "--quiet").returncode == 0
    process = toys.start("run", config, "--quiet", env={**os.environ, "PYTHONPROFILEIMPORTTIME": "1"})
    _, import_times = process.communicate(timeout=120)
    assert process.returncode == 0
    imported = {line.rpartition("|")[2].strip() for line in import_times.splitlines() if line.startswith("import time:")}
    assert "numpy" in imported
    assert not imported & {"dask", "distributed", "zarr", "obstore", "scipy", "numba", "matplotlib"}
    assert json.loads((toys.output / "run.json").read_text())["nodes"]["ran"] == 0
