"""Records of runs: what each did, and which nodes it used.

    runs/<run>.json      one run, sealed; `nodes` names its list, `states` holds what is not the same in all runs with that list
    nodes/<digest>.json  the nodes of runs by label: those that used the same share one list

A head is a run without its nodes, of which there may be a hundred thousand: what does not ask for them does not read them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from kinetree.pipeline.identity.key import digest
from kinetree.pipeline.storage.place import Place
from kinetree.pipeline.storage.sealed import sealed, unsealed


@dataclass(frozen=True)
class RunRecords:
    """The runs on record in one place."""

    place: Place
    _lists: dict[str, Any] = field(default_factory=dict)
    """The list that was read last: one run after the other has the same."""

    def names(self) -> list[str]:
        """Identifiers of the runs, oldest first."""
        return [n.removesuffix(".json") for n in self.place.names("runs") if n.endswith(".json")]

    def heads(self) -> list[dict[str, Any]]:
        """The runs without their nodes, oldest first, without those that cannot be read; `list` names a run's nodes."""
        by_path = self.place.get_all([run_path(name) for name in self.names()])
        heads = (_head(data, path) for path, data in by_path.items())
        return [head for head in heads if head is not None]

    def head(self, name: str) -> dict[str, Any] | None:
        """One run without its nodes; None where there is none or it cannot be read."""
        return _head(self.place.get(run_path(name)), run_path(name))

    def nodes(self, head: Mapping[str, Any]) -> dict[str, Any] | None:
        """The nodes of a run by label; None where they cannot be read."""
        name, states = head["list"], head["states"]
        listed = self._list(name) if name else {}
        if not isinstance(listed, dict) or not all(isinstance(node, dict) for node in listed.values()):
            return None  # damaged, or another sealed file in its place
        return {label: {"state": states.get(label, "fresh"), **node} for label, node in listed.items()}

    def write(self, name: str, run: Mapping[str, Any]) -> None:
        """Writes or replaces the record of one run; its nodes lie apart."""
        nodes = run["nodes"]
        states = {label: node["state"] for label, node in nodes.items() if node.get("state", "fresh") != "fresh"}
        listed = {label: {k: v for k, v in node.items() if k != "state"} for label, node in nodes.items()}
        record = {**run, "nodes": self._put_list(listed), "states": states}
        self.place.put(run_path(name), sealed(record))

    def _list(self, name: str) -> Any:
        if name not in self._lists:
            content = unsealed(self.place.get(list_path(name)))
            self._lists.clear()
            self._lists[name] = content
        return self._lists[name]

    def _put_list(self, content: Mapping[str, Any]) -> str:
        """Writes a list, unless it is there; returns its name, none for an empty one."""
        if not content:
            return ""
        name = digest(content)
        if unsealed(self.place.get(list_path(name))) is None:
            self.place.put(list_path(name), sealed(content))
        return name


def run_path(name: str) -> str:
    """Where in a store the record of a run lies."""
    return f"runs/{name}.json"


def list_path(name: str) -> str:
    """Where in a store a list of a run's nodes lies."""
    return f"nodes/{name}.json"


def _head(data: bytes | None, path: str) -> dict[str, Any] | None:
    """The run of a file; None where it is damaged or that of another run or thing."""
    run = unsealed(data)
    if not isinstance(run, dict) or not isinstance(run.get("nodes"), str) or not isinstance(run.get("states"), dict):
        return None
    if run_path(str(run.get("name", ""))) not in (path, run_path("")):
        return None
    return {**{name: value for name, value in run.items() if name != "nodes"}, "list": run["nodes"]}
