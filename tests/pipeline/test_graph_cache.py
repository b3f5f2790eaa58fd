"""Laws of kept graphs: they say what the imported ones say, and what was kept of other code is never taken."""

import json
import sys
from dataclasses import replace

import pytest

from kinetree.errors import ClusterError, GraphError
from kinetree.pipeline import graph_cache
from kinetree.pipeline.graph_cache import import_functions, kept_graphs
from kinetree.pipeline.identity import kept, own_code
from kinetree.tasks.methods import DATA_SETS, METHODS

REFERENCE = "kinetree.tasks.methods:METHODS"


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    """The folder of kept graphs, empty; what this process remembers is forgotten before and after."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    forget()
    yield tmp_path / "kinetree" / "graphs"
    forget()


def forget():
    own_code.forget_code()
    graph_cache._graphs.cache_clear()


def read_again(reference=REFERENCE):
    """The graphs as the next process has them."""
    kept_graphs(reference)
    forget()
    return kept_graphs(reference)


def test_kept_graphs_say_what_the_imported_ones_say():
    again = read_again()
    assert list(again) == list(METHODS)
    for method, graph in METHODS.items():
        read = again[method]
        assert read is not graph
        assert [task.summary for task in read.tasks] == [task.summary for task in graph.tasks]
        assert [task.paper for task in read.tasks] == [task.paper for task in graph.tasks]
        assert [task.module for task in read.tasks] == [task.module for task in graph.tasks]
        same = tuple(replace(task, function=graph.task(task.name).function) for task in read.tasks)
        assert same == graph.tasks


def test_a_graph_alone_is_kept_too_with_its_linked_tasks():
    read = read_again("kinetree.tasks.methods:DATA_SETS")[""]
    assert read is not DATA_SETS
    assert [(t.name, t.is_linked, t.over) for t in read.tasks] == [(t.name, t.is_linked, t.over) for t in DATA_SETS.tasks]


def test_a_kept_task_computes_what_the_imported_one_computes():
    read, real = (graphs["mesoscopic"].task("source") for graphs in (read_again(), METHODS))
    params = real.params(synth={"figure": "human", "frames": 3, "vertices": 200})
    assert read(params=params, files=None) == real(params=params, files=None)


def test_code_digests_that_are_gone_are_kept_again(home):
    kept_graphs(REFERENCE)
    for file in home.with_name("code").glob("*.json"):
        file.unlink()
    forget()
    assert kept_graphs(REFERENCE)["mesoscopic"] is not METHODS["mesoscopic"]
    assert [*home.with_name("code").glob("*.json")]


def test_other_code_finds_nothing(monkeypatch):
    assert read_again()["reeb"] is not METHODS["reeb"]
    monkeypatch.setattr(graph_cache, "code_state", lambda: "other")
    assert kept_graphs(REFERENCE)["reeb"] is METHODS["reeb"]


def test_a_damaged_file_is_none(home):
    kept_graphs(REFERENCE)
    (file,) = home.glob("*.json")
    file.write_bytes(file.read_bytes().replace(b"mesoscopic", b"mesoscopik"))
    graph_cache._graphs.cache_clear()
    assert kept_graphs(REFERENCE)["reeb"] is METHODS["reeb"]


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("module", "os", "kept graphs name os, which is none of kinetree.tasks, kinetree.schemas"),
        ("returns", "subprocess:Popen", "kept graphs name subprocess, which is none of"),
        ("returns", "kinetree.schemas.array:Params", "kept graphs name kinetree.schemas.array:Params, which is no Artifact"),
        ("params", "kinetree.schemas.array:Floats", "which is no Params; delete the folder kinetree/graphs"),
    ],
)
def test_kept_graphs_may_name_nothing_but_tasks_and_schemas(home, name, value, words):
    kept_graphs(REFERENCE)
    (file,) = home.glob("*.json")
    rows = kept.read(file)
    rows["reeb"][3][name] = value
    kept.write(file, rows)
    graph_cache._graphs.cache_clear()
    with pytest.raises(GraphError, match=words):
        kept_graphs(REFERENCE)["reeb"]


def test_graphs_of_other_packages_are_not_kept(toys, home):
    assert kept_graphs(f"{toys.module.__name__}:GRAPH")[""] is toys.module.GRAPH
    assert not [*home.glob("*.json")]


def test_code_that_is_edited_after_it_was_planned_with_is_not_imported(monkeypatch):
    read = read_again()["mesoscopic"].until(["sequence"])
    stamps = dict(own_code._stamps())
    monkeypatch.setattr(own_code, "_stamps", lambda: {**stamps, "kinetree.tasks.input.mesh": (0, 0)})
    import_functions(read)  # they are all imported already, as they were
    monkeypatch.delitem(sys.modules, "kinetree.tasks.input.sequence")
    with pytest.raises(ClusterError, match="was edited after this process had planned with it; run again"):
        import_functions(read)


def test_what_was_kept_is_plain_text(home):
    kept_graphs(REFERENCE)
    (file,) = home.glob("*.json")
    assert set(json.loads(file.read_text())) == {"format", "sum", "content"}
    assert sys.getsizeof(file.read_bytes()) < 2**20
