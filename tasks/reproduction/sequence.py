"""The sequence that both methods are run on, and their runs: one output folder each, one store for all."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml

from kinetree.errors import InputError, NodesFailedError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.schemas.structure.skeleton import Skeleton

PRESETS = ("paper-2014", "default")
"""The methods that are compared, by the names of their presets."""


@dataclass(frozen=True)
class Sequence:
    """What is computed: the user's sequence, or the generated body of the demonstration."""

    output: Path
    input: Path | None = None
    truth: Path | None = None
    sets: tuple[str, ...] = ()
    """Parameters as task.name=value, for both methods."""
    tell: Callable[[str], None] = lambda _: None
    """Is told what is being computed."""

    @property
    def name(self) -> str:
        """As a table calls it."""
        return "generated" if self.input is None else self.input.name

    def run(self, preset: str, *changes: str, until: tuple[str, ...] = ("evaluation",), beside: str = "") -> "Run":
        """Computes what is out of date with a preset.

        until   : the tasks that are wanted, with those they need
        changes : more parameters as task.name=value
        beside  : ending of the output folder's name, for a run with changes
        raises  : NodesFailedError naming the first node that failed; InputError where the sequence is wrong
        """
        folder = self.output / f"{preset}{beside}"
        self.tell(f"computing {folder}")
        pipeline = Pipeline.of(_preset(preset), sets=[*self._source(), *self.sets, *changes, *self._folders(folder)])
        summary = pipeline.run(until=until)
        for failure in summary["failures"]:
            text = f"{folder}: {failure['node']}: {failure['message']}"
            raise InputError(text) if failure["error"] == InputError.__name__ else NodesFailedError(text)
        return Run(preset, pipeline, pipeline.inspect(until=until))

    def _source(self) -> list[str]:
        if self.input is not None:
            source = [f"source.input={_quoted(self.input)}"]
        else:
            generated: Any = Pipeline.of(_preset("demo")).config.params["source"]
            source = [f"source.synth={generated.synth.model_dump_json()}"]
        return source if self.truth is None else [*source, f"truth.file={_quoted(self.truth)}"]

    def _folders(self, folder: Path) -> list[str]:
        return [f"output={_quoted(folder)}", f"store={_quoted(self.output / 'store')}"]


@dataclass(frozen=True)
class Run:
    """One method on the sequence, computed."""

    preset: str
    pipeline: Pipeline
    there: Snapshot

    @property
    def frames(self) -> list[int]:
        """Numbers of the frames, ascending."""
        return sorted(node.at[0] for node in self.there.schedule.entries if node.task == "source")

    def fetch(self, name: str, **index: int) -> Any:
        """An artifact by its task; `skeleton` is that of the method, whatever its task is called."""
        return self.there.artifact(self.pipeline.tasks.writers[Skeleton].name if name == "skeleton" else name, **index)

    def some(self, count: int) -> list[int]:
        """So many frames spread over the sequence."""
        last = len(self.frames) - 1
        return sorted({self.frames[round(i * last / max(count - 1, 1))] for i in range(count)})


def _preset(name: str) -> dict[str, Any]:
    """The preset itself, even where the current folder has a run of that name."""
    blocks: dict[str, Any] = yaml.safe_load((files("kinetree.configs") / f"{name}.yaml").read_text(encoding="utf-8"))
    return blocks


def _quoted(path: Path) -> str:
    return json.dumps(str(path.absolute()))
