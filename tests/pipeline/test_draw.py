"""Laws of drawing: every node and edge in each format, quoted so that no name can break out."""

import json

import networkx as nx
import pytest

from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.draw import draw
from kinetree.tasks import METHODS


@pytest.fixture
def tasks():
    return METHODS["mesoscopic"].networkx()


def test_mermaid_has_every_task_and_edge_and_thick_ones_for_gathers(tasks):
    first, *lines = draw(tasks, "mermaid").splitlines()
    assert first == "flowchart TD"
    assert len(lines) == len(tasks.nodes) + len(tasks.edges)
    number = {node: f"n{k}" for k, node in enumerate(tasks.nodes)}
    assert f'    {number["mesh"]}["mesh · per frame"]' in lines
    assert f'    {number["sequence"]}["sequence"]' in lines
    assert f"    {number['source']} --> {number['mesh']}" in lines
    assert f"    {number['mesh']} ==> {number['connectivity']}" in lines


def test_dot_has_every_task_and_edge_and_bold_ones_for_gathers(tasks):
    lines = draw(tasks, "dot").splitlines()
    assert (lines[0], lines[-1]) == ("digraph tasks {", "}")
    assert '    "mesh" [label="mesh · per frame"];' in lines
    assert '    "source" -> "mesh";' in lines
    assert '    "mesh" -> "connectivity" [style=bold];' in lines
    assert len(lines) == 3 + len(tasks.nodes) + len(tasks.edges)


def test_json_is_the_graph(tasks):
    drawn = json.loads(draw(tasks, "json"))
    assert [n["name"] for n in drawn["nodes"]] == list(tasks.nodes)
    assert {(e["from"], e["to"]) for e in drawn["edges"]} == set(tasks.edges)
    mesh = next(n for n in drawn["nodes"] if n["name"] == "mesh")
    assert (mesh["over"], mesh["artifact"], mesh["params"]) == ("frame", "Mesh", "MeshParams")


def test_quotes_and_backslashes_stay_within_their_label():
    graph = nx.DiGraph()
    graph.add_node('a"b\\', over="")
    assert '    "a\\"b\\\\" [label="a\\"b\\\\"];' in draw(graph, "dot")


def test_states_are_grouped_by_task_and_told_one_by_one_when_expanded(tmp_path):
    for t in range(3):
        (tmp_path / f"{t}.off").write_text("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n")
    pipeline = Pipeline.of({"source": {"input": str(tmp_path)}, "output": str(tmp_path / "out")})
    grouped, expanded = pipeline.graph(), pipeline.graph(expanded=True)
    assert "mesh ×3: 3 stale" in draw(grouped, "mermaid")
    assert '[label="mesh ×3: 3 stale"]' in draw(grouped, "dot")
    drawn = {n["name"]: n for n in json.loads(draw(grouped, "json"))["nodes"]}
    assert drawn["mesh"]["states"] == {"stale": 3}
    assert "mesh[frame=1]: stale" in draw(expanded, "mermaid")
    drawn = {n["name"]: n for n in json.loads(draw(expanded, "json"))["nodes"]}
    assert drawn["mesh[frame=1]"]["state"] == "stale"
    assert drawn["connectivity"]["state"] == "waits"
