"""The graph as text: mermaid, dot or JSON; nodes grouped by task unless expanded."""

import json
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import networkx as nx

Format = Literal["mermaid", "dot", "json"]
GATHERS = ("tuple", "mapping")


def draw(graph: "nx.DiGraph[str]", form: Format) -> str:
    """The graph that `Pipeline.graph` or `Graph.networkx` gives, in one of the three formats."""
    if form == "json":
        return json.dumps(_plain(graph), indent=2, ensure_ascii=False)
    return _mermaid(graph) if form == "mermaid" else _dot(graph)


def _mermaid(graph: "nx.DiGraph[str]") -> str:
    names = {node: f"n{number}" for number, node in enumerate(graph.nodes)}
    lines = ["flowchart TD"]
    lines += [f'    {names[node]}["{_node_text(node, data)}"]' for node, data in graph.nodes(data=True)]
    for a, b, data in graph.edges(data=True):
        lines.append(f"    {names[a]} {_arrow(data)} {names[b]}")
    return "\n".join(lines)


def _dot(graph: "nx.DiGraph[str]") -> str:
    lines = ["digraph tasks {", "    node [shape=box];"]
    lines += [f"    {_quoted(node)} [label={_quoted(_node_text(node, data))}];" for node, data in graph.nodes(data=True)]
    for a, b, data in graph.edges(data=True):
        style = "dashed" if data.get("previous") else "bold" if data.get("form") in GATHERS else ""
        lines.append(f"    {_quoted(a)} -> {_quoted(b)}{f' [style={style}]' if style else ''};")
    return "\n".join([*lines, "}"])


def _arrow(data: dict[str, Any]) -> str:
    """Thick for a gather, dotted for what is read at a previous member."""
    if data.get("previous"):
        return "-.->"
    return "==>" if data.get("form") in GATHERS else "-->"


def _plain(graph: "nx.DiGraph[str]") -> dict[str, Any]:
    nodes = []
    for name, data in graph.nodes(data=True):
        rest = {key: value for key, value in data.items() if key != "data"}
        row = data.get("data")
        rest |= {"state": row.state} if hasattr(row, "state") else {}
        rest |= {"states": row.states} if hasattr(row, "states") else {}
        nodes.append({"name": name, **rest})
    edges = [{"from": a, "to": b, **data} for a, b, data in graph.edges(data=True)]
    return {"nodes": nodes, "edges": edges}


def _node_text(node: str, data: dict[str, Any]) -> str:
    """E.g. "geodesics ×412: 409 fresh, 3 stale" for a task with a plan, "mesh · per frame" without one."""
    row = data.get("data")
    if row is None:
        return f"{node} · per {data['over'].replace('/', ' and ')}" if data.get("over") else node
    if hasattr(row, "states"):
        return str(row).split(" — ")[0]
    return f"{node}: {row.state}"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
