"""The configuration of a data set: which sequences, what all of them share, what some have of their own.

sequences: takes/*          one folder or file each; or a list, or names with paths
name: "{stem}"              how a name is made of a path
output: results/{name}
store: results/store        shared
overrides: {walk_07: {task: {parameter: value}}, "dance_*": …}
compute, on_failure, metrics, retention, and the blocks of tasks, which all sequences share; in their paths {name} and {input}
stand for each sequence's name and path
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, field_validator

from kinetree.errors import ConfigError
from kinetree.pipeline.application import Application
from kinetree.pipeline.dataset.overlap import OUTPUT, refuse_overlap
from kinetree.pipeline.dataset.sequences import NAME, sequences
from kinetree.pipeline.settings.blocks import Reading, absolute, extended, merged, override, read_yaml, with_paths
from kinetree.pipeline.settings.config import RUN_KEYS, Compute, Config, Origins, checked, resolved
from kinetree.pipeline.storage.sizes import bytes_of
from kinetree.pipeline.suggest import nearest

KEYS = ("sequences", "name", "overrides", "on_failure", "metrics", "retention")
"""The keys that a data set has beside those of a single run."""
STORE = "store"
INPUT = "{input}"
"""Stands in paths of parameters for the sequence's own path."""


class Retention(BaseModel):
    """What is deleted from the store at the end of a run; without any of the first three nothing is."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    keep_last: int | None = Field(default=None, ge=1)
    """Runs of each sequence whose results stay."""
    keep_days: float | None = Field(default=None, ge=0)
    """Results of runs of so many days stay as well."""
    max_size: str | None = None
    """Oldest results go until the store is no larger, e.g. 200GB."""
    logs: int = Field(default=5, ge=1)
    """Logs that are kept beside the one that is written."""
    log_size: str = "10MB"
    """Size from which the next run begins another log."""

    @field_validator("max_size", "log_size")
    @classmethod
    def _is_a_size(cls, size: str | None) -> str | None:
        if size is not None:
            bytes_of(size)
        return size

    @property
    def deletes(self) -> bool:
        """Whether anything is deleted."""
        return (self.keep_last, self.keep_days, self.max_size) != (None, None, None)


@dataclass(frozen=True)
class DatasetConfig:
    """A checked data set: a configuration for every sequence, by name."""

    file: str
    """Where it was read from, for messages."""
    root: Path
    """The folder in which the data set's own results lie, above those of its sequences."""
    store: Path | str
    sequences: Mapping[str, Config]
    inputs: Mapping[str, str]
    """Path or pattern of every sequence."""
    compute: Compute
    on_failure: tuple[str, ...] = ()
    """A program and its arguments; the path of the summary is added as the last."""
    metrics: Path | None = None
    """The file to which a run writes its metrics; None writes none."""
    retention: Retention = field(default_factory=Retention)
    notes: tuple[str, ...] = ()
    """What is to be known, e.g. that a pattern matches nothing."""


def load(target: str | Path | Mapping[str, Any], application: Application, sets: Iterable[str] = ()) -> DatasetConfig:
    """The data set that a YAML file or a mapping describes.

    sets   : overrides for all sequences as task.name=value
    raises : ConfigError, naming file and key
    """
    reading = Reading.of(application.methods(), application.presets)
    content, where, base = _read(target)
    known = {task.name for graph in application.methods().values() for task in graph.tasks if task.sets is not None}
    for key in content:
        if key not in {*known, *RUN_KEYS, *KEYS}:
            raise ConfigError(f"{where}: no such key {key!r}; {nearest(str(key), {*known, *RUN_KEYS, *KEYS})}")
    if "sequences" not in content:
        meant = [key for key in get_close_matches("sequences", content, cutoff=0.8) if not isinstance(content[key], Mapping)]
        hint = f"; did you mean it by {meant[0]!r}?" if meant else ", e.g. sequences: takes/*"
        raise ConfigError(f"{where}: sequences is missing: say which there are{hint}")
    inputs, notes = sequences(content["sequences"], content.get("name", "{stem}"), base, where)
    template = _output(content.get("output", OUTPUT), where)
    shared = {key: value for key, value in content.items() if key not in KEYS}
    blocks, _ = extended({**shared, "output": template}, base, where, (), reading)
    for key in KEYS:
        if key in blocks:
            raise ConfigError(
                f"{where}: extends {content['extends']!r}, which is a data set itself: it has {key!r}; a data set extends a"
                " preset or a configuration, so write what both share into a file of its own and extend that"
            )
    sets = tuple(sets)
    for text in sets:
        override(blocks, text, reading.paths)
    template = str(blocks["output"])
    root = _above_name(template)
    blocks.setdefault("store", str(root / STORE))
    options = {text.partition("=")[0].strip(): f"--set {text}" for text in sets}
    parameter = _input_parameter(application, blocks, where)
    own = _overrides(content.get("overrides"), where)
    missing: dict[str, list[str]] = {}

    def configured(name: str, patterns: Iterable[str], missing: dict[str, list[str]]) -> Config:
        mine, origins = dict(blocks), dict(options)
        for pattern in patterns:
            mine = merged(mine, absolute(own[pattern], base, reading.paths))
            origins |= dict.fromkeys(_leaves(own[pattern]), f"{where}: overrides.{pattern}")
        mine = merged(_filled(mine, name, inputs[name], reading, missing), _nested(parameter, inputs[name]))
        return resolved(mine, Origins(where, frozenset(content), origins), application, reading)

    configs = {name: configured(name, [p for p in own if fnmatchcase(name, p)], missing) for name in inputs}
    first_name, first = next(iter(configs.items()))
    refuse_overlap(configs, inputs, content["sequences"], base, where)
    lost = [pattern for pattern in own if not any(fnmatchcase(name, pattern) for name in inputs)]
    for pattern in lost:  # of sequences to come, which it must not refuse then
        configured(first_name, [pattern], {})
    notes += [f"overrides.{pattern}: no sequence has this name; {nearest(pattern, inputs)}" for pattern in lost]
    notes += [f"{path}: there is none for {_some(names)}" for path, names in missing.items()]
    retention = checked(Retention, content.get("retention") or {}, "retention", Origins(where, frozenset(content), {}))
    hook = _hook(content.get("on_failure"), where)
    metrics = _metrics(content.get("metrics"), base, where)
    return DatasetConfig(where, root, first.store, configs, inputs, first.compute, hook, metrics, retention, tuple(notes))


def with_compute(config: DatasetConfig, compute: Compute) -> DatasetConfig:
    """The data set computed elsewhere or wider."""
    moved = {name: replace(one, compute=compute) for name, one in config.sequences.items()}
    return replace(config, sequences=moved, compute=compute)


def _read(target: str | Path | Mapping[str, Any]) -> tuple[dict[str, Any], str, Path]:
    if isinstance(target, Mapping):
        return dict(target), "data set", Path.cwd()
    path = Path(target).expanduser()
    if not path.is_file():
        raise ConfigError(f"{path}: there is no such file; a data set is a YAML file with the keys sequences and output")
    return read_yaml(path), str(path), path.absolute().parent


def _output(output: Any, where: str) -> str:
    if not isinstance(output, str) or NAME not in output:
        raise ConfigError(f"{where}: output: {output!r} has no {NAME}; every sequence needs a folder of its own, e.g. {OUTPUT}")
    return output


def _above_name(template: str) -> Path:
    """The folder above the part of a path that differs by sequence."""
    above, _, _ = template.partition(NAME)
    return Path(above) if above.endswith("/") else Path(above).parent


def _input_parameter(application: Application, blocks: Mapping[str, Any], where: str) -> tuple[str, ...]:
    """The keys of the parameter that says what a run reads, which nothing but `sequences` may set."""
    written = next((s.parameter for s in application.shortcuts if s.is_input), None)
    if written is None:
        raise ConfigError(f"{where}: {application.name} has no parameter that says what a run reads; it has no data sets")
    keys = tuple(written.split("."))
    value: Any = blocks
    for key in keys:
        value = value.get(key) if isinstance(value, Mapping) else None
    if value:
        raise ConfigError(f"{where}: {written}: the sequences say what is read; remove it")
    return keys


def _overrides(block: Any, where: str) -> dict[str, dict[str, Any]]:
    if block is None:
        return {}
    if not isinstance(block, Mapping):
        raise ConfigError(f"{where}: overrides: expected names of sequences with blocks of parameters, got {block!r}")
    for name, blocks in block.items():
        if not isinstance(blocks, Mapping):
            raise ConfigError(f"{where}: overrides.{name}: expected blocks of parameters, got {blocks!r}")
        shared = [key for key in blocks if key in (*KEYS, "extends", "output", "store", "compute")]
        if shared:
            raise ConfigError(f"{where}: overrides.{name}: {shared[0]} is the same for all sequences; set it at the top")
    return {str(name): dict(blocks) for name, blocks in block.items()}


def _hook(command: Any, where: str) -> tuple[str, ...]:
    if command is None:
        return ()
    if not isinstance(command, list) or not command or not all(isinstance(part, str) and part for part in command):
        raise ConfigError(
            f"{where}: on_failure: expected a program and its arguments as a list, e.g. [notify, --to, lab], got {command!r};"
            " no shell reads it"
        )
    return tuple(command)


def _metrics(file: Any, base: Path, where: str) -> Path | None:
    if file is None:
        return None
    if not isinstance(file, str) or not file or "://" in file:
        raise ConfigError(f"{where}: metrics: expected the path of a file, e.g. metrics: results/metrics.prom, got {file!r}")
    path = base / Path(file).expanduser()
    if path.is_dir():
        raise ConfigError(f"{where}: metrics: {path} is a folder; name a file in it, e.g. {path / 'metrics.prom'}")
    if path.exists() and not path.is_file():
        raise ConfigError(f"{where}: metrics: {path} is no file, and would be replaced by one; name another path")
    return path


def _filled(blocks: dict[str, Any], name: str, path: str, reading: Reading, missing: dict[str, list[str]]) -> dict[str, Any]:
    """The blocks with {name} and {input} in paths replaced; a parameter whose file is not there is left out and noted."""

    def filled(written: str) -> str:
        if INPUT in written:
            place = path + written.partition(INPUT)[2].replace(NAME, name)
        elif NAME in written:
            place = written.replace(NAME, name)
        else:
            return written
        if written != blocks.get("output") and not Path(place).exists():
            missing.setdefault(written[written.find("{") :], []).append(name)
            return ""
        return place

    return with_paths(blocks, reading.paths, filled)


def _some(names: list[str]) -> str:
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def _leaves(blocks: Mapping[str, Any]) -> Iterable[str]:
    for key, value in blocks.items():
        yield str(key)
        if isinstance(value, Mapping):
            yield from (f"{key}.{inner}" for inner in _leaves(value))


def _nested(keys: tuple[str, ...], value: Any) -> dict[str, Any]:
    for key in reversed(keys):
        value = {key: value}
    return dict(value)
