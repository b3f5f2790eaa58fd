"""A networkx graph that a shell shows as text and a notebook as a drawing."""

from typing import Any

import networkx as nx

from kinetree.pipeline.inspection.draw import draw
from kinetree.pipeline.inspection.look import html_table

LINES_SHOWN = 40
"""Nodes that text and tables list, in lines; longer graphs end in how many more there are."""
NODES_DRAWN = 300
"""Nodes above which a notebook shows a table: larger drawings are slow and cannot be read."""


class DrawnGraph(nx.DiGraph):  # type: ignore[misc]
    """A directed graph of tasks or of nodes by name; a node's `data` is its row of the plan, edges name arguments."""

    def __repr__(self) -> str:
        """How many nodes and edges there are, then one line a node with what it reads."""
        lines = [f"{self.number_of_nodes()} nodes, {self.number_of_edges()} edges"]
        lines += [f"  {name}{state} ← {reads}" if reads else f"  {name}{state}" for name, state, reads in self._rows()]
        return "\n".join(lines + self._more())

    def _repr_html_(self) -> str:
        return html_table(("node", "state", "reads"), [*self._rows(), *((text, "", "") for text in self._more())])

    def _repr_mimebundle_(self, **_: Any) -> dict[str, str]:
        """Text and a table, and a drawing for notebooks that know mermaid."""
        bundle = {"text/plain": repr(self), "text/html": self._repr_html_()}
        return bundle | ({"text/vnd.mermaid": draw(self, "mermaid")} if len(self) <= NODES_DRAWN else {})

    def _rows(self) -> list[tuple[str, str, str]]:
        listed = list(self.nodes(data="data"))[:LINES_SHOWN]
        return [(name, _state(row), _some(sorted(self.predecessors(name)))) for name, row in listed]

    def _more(self) -> list[str]:
        return [f"… and {len(self) - LINES_SHOWN} more"] if len(self) > LINES_SHOWN else []


def _state(row: Any) -> str:
    """The state of a node, or how many nodes of a task are in which."""
    if hasattr(row, "states"):
        return ": " + ", ".join(f"{count} {state}" for state, count in row.states.items())
    return f": {row.state}" if hasattr(row, "state") else ""


def _some(names: list[str]) -> str:
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
