"""Configuration: one block of parameters per task, and what cannot change a result (output, store, compute) beside them.

A value comes from, last wins: the schema's default, the preset a file `extends`, the file, `--set task.name=value`.
"""

import importlib.resources
import os
import re
import reprlib
import typing
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from kinetree.pipeline.errors import ConfigError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.suggest import nearest
from kinetree.pipeline.yaml_text import parsed
from kinetree.schemas.array import Params

PRESETS = importlib.resources.files("kinetree.configs")
SAVED = "config.yaml"
"""Name under which a run leaves its configuration in its output folder."""
M = TypeVar("M", bound=BaseModel)
Paths = Mapping[str, frozenset[tuple[str, ...]]]
"""The parameters that are paths, by task, each as the keys that lead to it."""
RUN_KEYS = ("extends", "method", "output", "store", "compute")


class Compute(BaseModel):
    """Where and how wide a run is computed; never part of a key."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    executor: Literal["sync", "threads", "processes"] = "threads"
    """sync: in this thread, for debugging; threads: in this process; processes: worker processes of this machine."""
    workers: int | None = Field(default=None, ge=1, le=4096)
    """How many at the same time; None takes one per core."""
    memory: str | None = None
    """Memory limit of one worker process, e.g. 4GB; None sets none."""
    scheduler: str | None = Field(default=None, min_length=1)
    """Address of a running dask scheduler, e.g. tcp://host:8786; takes precedence over executor."""

    @field_validator("memory")
    @classmethod
    def _is_a_size(cls, told: str | None) -> str | None:
        if told is not None and not re.fullmatch(r"[0-9]+(\.[0-9]+)? ?([kMGT]i?)?B", told):
            raise ValueError("expected a size such as 4GB or 512MiB")
        return told

    @property
    def worker_count(self) -> int:
        """Workers to start on this machine."""
        return self.workers or len(os.sched_getaffinity(0))


@dataclass(frozen=True)
class Config:
    """A checked configuration; `params` has an entry for every task that has parameters."""

    method: str
    params: Mapping[str, Params]
    output: Path
    store: Path
    compute: Compute

    def saved(self) -> dict[str, Any]:
        """What differs from the defaults, as the YAML a run leaves in its output folder; paths are absolute."""
        told: dict[str, Any] = {"method": self.method, "output": str(self.output), "store": str(self.store)}
        for name, params in self.params.items():
            changed = params.model_dump(mode="json", exclude_defaults=True)
            if changed:
                told[name] = changed
        compute = self.compute.model_dump(mode="json", exclude_defaults=True)
        return {**told, "compute": compute} if compute else told


def load(target: str | Path | Mapping[str, Any] | None, methods: Mapping[str, Graph], sets: Iterable[str] = ()) -> Config:
    """The configuration at `target`: a YAML file, a preset's name, an earlier run's output folder, a mapping, or nothing.

    sets   : overrides as task.name=value, the value in YAML
    raises : ConfigError, naming file and key, with the nearest known key
    """
    paths = _path_fields(methods)
    blocks, where = _blocks(target, paths)
    for text in sets:
        _override(blocks, text, paths)
    method = blocks.get("method", "mesoscopic")
    if not isinstance(method, str) or method not in methods:
        raise ConfigError(f"{where}: method {method!r}; {nearest(str(method), methods)}")
    graph = methods[method]
    known = {task.name: task.params for task in graph.tasks if task.params is not None}
    _refuse_unknown(blocks, {*known, *RUN_KEYS}, where)
    params = {name: checked(cls, _block(blocks, name), f"{where}: {name}") for name, cls in known.items()}
    output = _folder(blocks, "output", where) or Path("kinetree-output").absolute()
    store = _folder(blocks, "store", where) or output / "store"
    return Config(method, params, output, store, checked(Compute, _compute(blocks), f"{where}: compute"))


def with_compute(config: Config, **changes: Any) -> Config:
    """The configuration with some of its compute settings replaced; None leaves one as it is."""
    given = {k: v for k, v in changes.items() if v is not None}
    if "executor" in given:
        given.setdefault("scheduler", None)  # a scheduler that only the file names gives way to what is asked for now
    told = {**config.compute.model_dump(), **given}
    return replace(config, compute=checked(Compute, told, "compute"))


def checked(cls: type[M], values: Any, where: str) -> M:
    """The values as a model of `cls`; raises ConfigError that names the key, what was given and the nearest known key."""
    if not isinstance(values, Mapping):
        raise ConfigError(f"{where}: expected keys with values, got {_short(values)}")
    try:
        return cls.model_validate(dict(values))
    except ValidationError as error:
        told = [_told(where, cls, fault) for fault in error.errors()]
        raise ConfigError("\n".join(told)) from None


def preset_names() -> list[str]:
    """Names of the presets that ship with kinetree."""
    return sorted(f.name.removesuffix(".yaml") for f in PRESETS.iterdir() if f.name.endswith(".yaml"))


def _told(where: str, cls: type[BaseModel], fault: Any) -> str:
    key = ".".join(str(part) for part in fault["loc"])
    if fault["type"] == "extra_forbidden":
        return f"{where}.{key}: no such key; {nearest(str(fault['loc'][-1]), _keys_at(cls, fault['loc'][:-1]))}"
    what = fault["msg"].removeprefix("Value error, ")
    return f"{where}.{key}: {what[:1].lower()}{what[1:]}, got {_short(fault['input'])}"


def _keys_at(cls: type[BaseModel], place: Iterable[str | int]) -> Iterable[str]:
    """The keys of the model that lies at a place within another."""
    for part in place:
        waiting: list[Any] = [cls.model_fields[part].annotation] if part in cls.model_fields else []
        while waiting:
            kind = waiting.pop()
            if isinstance(kind, type) and issubclass(kind, BaseModel):
                cls = kind
                break
            waiting.extend(typing.get_args(kind))
    return cls.model_fields


def _path_fields(methods: Mapping[str, Graph]) -> Paths:
    tasks = [task for graph in methods.values() for task in graph.tasks]
    return {task.name: task.params.path_fields() for task in tasks if task.params is not None}


def _blocks(target: str | Path | Mapping[str, Any] | None, paths: Paths) -> tuple[dict[str, Any], str]:
    if target is None:
        return {}, "config"
    if isinstance(target, Mapping):
        return _extended(dict(target), Path.cwd(), "config", (), paths)
    path = _expanded(target)
    if path.is_dir():
        if not (path / SAVED).is_file():
            raise ConfigError(f"{path}: no {SAVED} in this folder, so it is not the output of a run; give a YAML file")
        path = path / SAVED
    if path.is_file():
        return _file(path, (), paths)
    if str(target) in preset_names():
        return _file(PRESETS / f"{target}.yaml", (), paths)
    raise ConfigError(f"{target}: no such file, output folder or preset; presets: {', '.join(preset_names())}")


def _file(path: Any, seen: tuple[str, ...], paths: Paths) -> tuple[dict[str, Any], str]:
    if str(path) in seen:
        raise ConfigError(f"{path}: extends itself through {' → '.join(seen)}")
    try:
        blocks = parsed(path.read_text(encoding="utf-8"), str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from None
    if blocks is not None and not isinstance(blocks, dict):
        raise ConfigError(f"{path}: expected keys with values at the top, got {type(blocks).__name__}")
    base = path.absolute().parent if isinstance(path, Path) else Path.cwd()
    return _extended(blocks or {}, base, str(path), (*seen, str(path)), paths)


def _extended(
    blocks: dict[str, Any], base: Path, where: str, seen: tuple[str, ...], paths: Paths
) -> tuple[dict[str, Any], str]:
    """The blocks with their paths made absolute, over those of the preset or file they extend."""
    blocks = _absolute(blocks, base, paths)
    parent = blocks.pop("extends", None)
    if parent is None:
        return blocks, where
    found = PRESETS / f"{parent}.yaml" if str(parent) in preset_names() else (base / _expanded(str(parent))).resolve()
    if not found.is_file():
        raise ConfigError(f"{where}: extends {parent!r}, which is neither a preset ({', '.join(preset_names())}) nor a file")
    below, _ = _file(found, seen, paths)
    return _merged(below, blocks), where


def _merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(below)
    for key, value in above.items():
        both = isinstance(value, Mapping) and isinstance(merged.get(key), Mapping)
        merged[key] = _merged(merged[key], value) if both else value
    return merged


def _absolute(blocks: dict[str, Any], base: Path, paths: Paths) -> dict[str, Any]:
    """Paths are relative to the file that names them."""
    told = dict(blocks)
    for key in ("output", "store"):
        if isinstance(told.get(key), str) and told[key] and "://" not in told[key]:
            told[key] = str(base / _expanded(told[key]))
    for task, fields in paths.items():
        for keys in fields:
            told = _with_path(told, (task, *keys), base)
    return told


def _with_path(blocks: Mapping[str, Any], keys: Sequence[str], base: Path) -> dict[str, Any]:
    """The blocks with the path at the end of the keys, if there is one, made absolute."""
    told = dict(blocks)
    value = told.get(keys[0])
    if len(keys) > 1 and isinstance(value, Mapping):
        told[keys[0]] = _with_path(value, keys[1:], base)
    elif len(keys) == 1 and isinstance(value, str) and value:
        told[keys[0]] = str(base / _expanded(value))
    return told


def _override(blocks: dict[str, Any], text: str, paths: Paths) -> None:
    key, equals, value = text.partition("=")
    task, dot, name = key.strip().partition(".")
    if not equals or not task or task == "extends":
        raise ConfigError(f"--set {text}: write task.name=value, e.g. --set mesh.component_share=0.1")
    bare = value.strip()
    given = bare if bare and not bare.strip(":") else parsed(value, f"--set {text}")  # all frames are written ":"
    if not dot:
        blocks.update(_absolute({task: given}, Path.cwd(), paths))
        return
    for inner in reversed(name.split(".")):
        given = {inner: given}
    block = blocks.get(task)
    if block is not None and not isinstance(block, Mapping):
        raise ConfigError(f"--set {text}: {task} has no keys of its own")
    blocks[task] = _merged(block or {}, _absolute({task: given}, Path.cwd(), paths)[task])


def _folder(blocks: Mapping[str, Any], key: str, where: str) -> Path | None:
    told = blocks.get(key)
    if told is None:
        return None
    if not isinstance(told, str) or not told:
        raise ConfigError(f"{where}: {key}: expected the path of a folder, got {_short(told)}; put it in quotes if it is one")
    if "://" in told:
        raise ConfigError(f"{where}: {key}: {told} is the address of a service, which is not supported yet; give a folder")
    return _expanded(told).absolute()


def _expanded(path: str | Path) -> Path:
    """The path with ~ replaced; one that names no user's home is a name like any other."""
    try:
        return Path(path).expanduser()
    except RuntimeError:
        return Path(path)


def _short(value: Any) -> str:
    """A value as a message can quote it: nested aliases can stand for more than memory holds."""
    quoting = reprlib.Repr()
    quoting.maxstring = quoting.maxother = 200
    return quoting.repr(value)


def _refuse_unknown(blocks: Mapping[str, Any], known: Iterable[str], where: str) -> None:
    for key in blocks:
        if key not in known:
            raise ConfigError(f"{where}: no such key {key!r}; {nearest(str(key), known)}")


def _block(blocks: Mapping[str, Any], name: str) -> Any:
    return {} if blocks.get(name) is None else blocks[name]


def _compute(blocks: Mapping[str, Any]) -> Any:
    """The compute block, or the named one of configs/compute."""
    found = blocks.get("compute")
    if not isinstance(found, str):
        return _block(blocks, "compute")
    names = sorted(f.name.removesuffix(".yaml") for f in (PRESETS / "compute").iterdir() if f.name.endswith(".yaml"))
    if found not in names:
        raise ConfigError(f"compute {found!r}; {nearest(found, names)}")
    return _file(PRESETS / "compute" / f"{found}.yaml", (), {})[0]
