"""A configuration in full, as YAML a person can edit: every parameter with its value and its sentence."""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.settings.config import Config
from kinetree.pipeline.settings.sentences import sentences
from kinetree.pipeline.settings.yaml_text import dumped

WIDTH = 118


def explained(config: Config, graph: Graph) -> str:
    """The configuration as YAML: a block per task in the order of the graph, its source above it."""
    lines = [f"method: {config.method}"]
    for task in graph.tasks:
        if task.sets is not None:
            cited = f" ({task.paper})" if task.paper else ""
            lines += ["", f"# {task.summary}{cited}", f"{task.name}:", *_block(config.params[task.name], 1)]
    return "\n".join(lines) + "\n"


def _block(values: BaseModel, depth: int) -> Iterator[str]:
    indent, meanings = "  " * depth, sentences(type(values))
    for name in type(values).model_fields:
        meaning = " ".join(meanings.get(name, "").split())
        value = getattr(values, name)
        if isinstance(value, BaseModel):
            yield f"{indent}{name}:  # {meaning}"
            yield from _block(value, depth + 1)
            continue
        line = f"{indent}{name}: {_value(value)}"
        yield f"{line}  # {meaning}" if len(line) + len(meaning) < WIDTH else f"{indent}# {meaning}\n{line}"


def _value(value: Any) -> str:
    """The value on one line of YAML."""
    plain = list(value) if isinstance(value, tuple) else value
    return dumped(plain, default_flow_style=True, allow_unicode=True, width=10_000).removesuffix("\n...\n").strip()
