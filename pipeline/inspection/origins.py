"""What the origins of a graph find: the members of a sequence as the input has them now, or as the last run found them."""

from collections.abc import Mapping
from typing import Any

from kinetree.errors import InputError, ServiceError
from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.inspection.history import History
from kinetree.pipeline.node import parse
from kinetree.pipeline.planning.layout import OriginArtifacts
from kinetree.pipeline.settings.config import Config
from kinetree.pipeline.storage.files import Files
from kinetree.schemas.array import Artifact, Index


def origin_artifacts(graph: Graph, config: Config, files: Files, history: History) -> tuple[OriginArtifacts, list[str]]:
    """What every origin of the graph finds, and remarks on what it did not.

    Where an output folder was named and its input is not to be found, as after a move, what its last run found is taken:
    a task that reads it checks that the bytes are the same.
    raises : InputError of an origin, where nothing of it is on record; ServiceError
    """
    artifacts: dict[str, Mapping[Index, Artifact]] = {}
    notes: list[str] = []
    for task in graph.tasks:
        if not task.is_origin or task.is_linked:
            continue
        try:
            listed = task(params=config.params[task.name], files=files)
            artifacts[task.name] = {(member,): value for member, value in listed.items()} if task.over else {(): listed}
        except ServiceError:  # it is there and cannot be asked now
            raise
        except InputError as error:
            recorded = _recorded(graph, task, config, history) if config.is_left else {}
            if not recorded:
                raise
            artifacts[task.name] = recorded
            notes.append(f"{task.name}: {error}; what the last run found there is used")
    return artifacts, notes


def _recorded(graph: Graph, task: AnyTask, config: Config, history: History) -> dict[Index, Artifact]:
    """The artifacts of an origin as the last run into this folder left them on record."""
    nodes: Mapping[str, Any] = history.origin(task.name, config.portable().get(task.name))
    return {parse(name, graph).at: task.returns.model_validate(values) for name, values in nodes.items()}
