"""A configuration before it is checked: blocks of keys from files, presets and overrides, with their paths made absolute."""

import importlib.resources
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from kinetree.errors import ConfigError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.suggest import nearest
from kinetree.pipeline.yaml_text import parsed

PRESETS = importlib.resources.files("kinetree.configs")
SAVED = "config.yaml"
"""Name under which a run leaves its configuration in its output folder."""
Paths = Mapping[str, frozenset[tuple[str, ...]]]
"""The parameters that are paths, by task, each as the keys that lead to it."""


def path_fields(methods: Mapping[str, Graph]) -> Paths:
    tasks = [task for graph in methods.values() for task in graph.tasks]
    return {task.name: task.params.path_fields() for task in tasks if task.params is not None}


def blocks_at(target: str | Path | Mapping[str, Any] | None, paths: Paths) -> tuple[dict[str, Any], str]:
    if target is None:
        return {}, "config"
    if isinstance(target, Mapping):
        return _extended(dict(target), Path.cwd(), "config", (), paths)
    path = expanded(target)
    if path.is_dir():
        if not (path / SAVED).is_file():
            raise ConfigError(f"{path}: no {SAVED} in this folder, so it is not the output of a run; give a YAML file")
        path = path / SAVED
    if path.is_file():
        return _file(path, (), paths)
    if str(target) in preset_names():
        return _file(PRESETS / f"{target}.yaml", (), paths)
    raise ConfigError(f"{target}: no such file, output folder or preset; presets: {', '.join(preset_names())}")


def override(blocks: dict[str, Any], text: str, paths: Paths) -> None:
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


def preset_names() -> list[str]:
    """Names of the presets that ship with kinetree."""
    return sorted(f.name.removesuffix(".yaml") for f in PRESETS.iterdir() if f.name.endswith(".yaml"))


def block(blocks: Mapping[str, Any], name: str) -> Any:
    return {} if blocks.get(name) is None else blocks[name]


def compute_block(blocks: Mapping[str, Any]) -> Any:
    """The compute block, or the named one of configs/compute."""
    found = blocks.get("compute")
    if not isinstance(found, str):
        return block(blocks, "compute")
    names = sorted(f.name.removesuffix(".yaml") for f in (PRESETS / "compute").iterdir() if f.name.endswith(".yaml"))
    if found not in names:
        raise ConfigError(f"compute {found!r}; {nearest(found, names)}")
    return _file(PRESETS / "compute" / f"{found}.yaml", (), {})[0]


def expanded(path: str | Path) -> Path:
    """The path with ~ replaced; one that names no user's home is a name like any other."""
    try:
        return Path(path).expanduser()
    except RuntimeError:
        return Path(path)


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
    found = PRESETS / f"{parent}.yaml" if str(parent) in preset_names() else (base / expanded(str(parent))).resolve()
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
            told[key] = str(base / expanded(told[key]))
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
        told[keys[0]] = str(base / expanded(value))
    return told
