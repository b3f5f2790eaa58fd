"""A configuration before it is checked: blocks of keys from files, presets and overrides, with their paths made absolute."""

import importlib.resources
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from kinetree.errors import ConfigError
from kinetree.errors.small_text import small_text
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.settings.yaml_text import parsed
from kinetree.pipeline.suggest import nearest

SAVED = "config.yaml"
"""Name under which a run leaves its configuration in its output folder."""
LARGEST = 4 * 2**20
"""Bytes of a configuration that is read."""
_OPEN_SLICE = re.compile(r"""[^\s'"#&*!|>%@`,\[\]{}]*:""")
"""A plain word that ends in a colon, as frames from one on are written: 2:, -5:, all of them :. YAML takes it for a key."""
Paths = Mapping[str, frozenset[tuple[str, ...]]]


@dataclass(frozen=True)
class Reading:
    """What the text of a configuration is read with."""

    paths: Paths
    """The parameters that are paths, by task, each as the keys that lead to it."""
    presets: Traversable | None
    """The folder of presets; None where the application has none."""

    @staticmethod
    def of(methods: Mapping[str, Graph], presets: str | None) -> "Reading":
        """For the graphs of an application and its package of presets."""
        return Reading(_PathsOf(methods), importlib.resources.files(presets) if presets is not None else None)

    @property
    def preset_names(self) -> list[str]:
        """Names of the presets, sorted."""
        return _yaml_names(self.presets)

    def preset(self, name: str) -> Traversable | None:
        """The file of a preset; None where there is no such preset."""
        return self.presets / f"{name}.yaml" if self.presets is not None and name in self.preset_names else None

    def compute(self, name: str) -> Traversable:
        """The file of named compute settings; raises ConfigError with the nearest name."""
        folder = self.presets / "compute" if self.presets is not None else None
        names = _yaml_names(folder)
        if folder is None or name not in names:
            raise ConfigError(f"compute {name!r}: no such compute settings; {nearest(name, names)}")
        return folder / f"{name}.yaml"


class _PathsOf(Mapping[str, frozenset[tuple[str, ...]]]):
    """The parameters that are paths, by task; graphs are looked through in order, as far as a name needs it."""

    def __init__(self, methods: Mapping[str, Graph]) -> None:
        self._methods = methods

    def __getitem__(self, name: str) -> frozenset[tuple[str, ...]]:
        params = next((graph.by_name[name].sets for graph in self._methods.values() if name in graph.by_name), None)
        if params is None:
            raise KeyError(name)
        return params.path_fields()

    def __iter__(self) -> Iterator[str]:
        names = dict.fromkeys(task.name for graph in self._methods.values() for task in graph.tasks if task.sets is not None)
        return iter(names)

    def __len__(self) -> int:
        return len(list(iter(self)))


def blocks_at(target: str | Path | Mapping[str, Any] | None, reading: Reading) -> tuple[dict[str, Any], str]:
    """The blocks at a YAML file, an output folder, a preset's name or in a mapping, and where they come from, for messages.

    raises : ConfigError
    """
    if target is None:
        return {}, "config"
    if isinstance(target, Mapping):
        return extended(dict(target), Path.cwd(), "config", (), reading)
    if not isinstance(target, str | os.PathLike):
        raise ConfigError(f"expected a file, an output folder, a preset or a mapping, got {target!r}")
    path = expanded(target)
    if path.is_dir():
        if not (path / SAVED).is_file():
            raise ConfigError(f"{path}: no {SAVED} in this folder, so it is not the output of a run; give a YAML file")
        return _moved(*_file(path / SAVED, (), reading), path.absolute())
    if path.is_file():
        return _file(path, (), reading)
    preset = reading.preset(str(target))
    if preset is not None:
        return _file(preset, (), reading)
    raise ConfigError(f"{target}: no such file, output folder or preset; presets: {', '.join(reading.preset_names) or 'none'}")


def is_output(target: object) -> bool:
    """Whether a target names the output folder of a run."""
    return isinstance(target, str | Path) and expanded(target).is_dir() and (expanded(target) / SAVED).is_file()


def override(blocks: dict[str, Any], text: str, paths: Paths) -> None:
    """Sets one parameter, written task.name=value, the value in YAML; raises ConfigError where it is not written so."""
    key, equals, value = text.partition("=")
    task, dot, name = key.strip().partition(".")
    if not equals or not task or task == "extends":
        raise ConfigError(f"--set {text}: write task.name=value; kinetree tasks lists every parameter")
    bare = value.strip()
    setting = bare if _OPEN_SLICE.fullmatch(bare) else parsed(value, f"--set {text}")
    if not dot:
        blocks.update(absolute({task: setting}, Path.cwd(), paths))
        return
    for inner in reversed(name.split(".")):
        setting = {inner: setting}
    block = blocks.get(task)
    if block is not None and not isinstance(block, Mapping):
        raise ConfigError(f"--set {text}: {task} has no keys of its own")
    blocks[task] = merged(block or {}, absolute({task: setting}, Path.cwd(), paths)[task])


def portable(blocks: Mapping[str, Any], folder: Path, paths: Paths) -> dict[str, Any]:
    """The blocks with their absolute paths made relative to a folder, for a file in it that moves with what it names.

    Below the folder and beside it paths become relative; those that lead elsewhere stay as they are.
    """

    def relative(path: str) -> str:
        way = os.path.relpath(path, folder)
        is_near = Path(path).is_relative_to(folder.parent) and _is_same(folder / way, Path(path))
        return path if not is_near else f"./{way}" if way.startswith("~") else way

    return with_paths(blocks, paths, relative)


def block(blocks: Mapping[str, Any], name: str) -> Any:
    """The block of that name; an empty one where there is none or nothing stands in it."""
    return {} if blocks.get(name) is None else blocks[name]


def compute_block(blocks: Mapping[str, Any], reading: Reading) -> Any:
    """The compute block, or the one of the presets that it names."""
    name = blocks.get("compute")
    return _file(reading.compute(name), (), reading)[0] if isinstance(name, str) else block(blocks, "compute")


def expanded(path: str | Path) -> Path:
    """The path with ~ replaced; one that names no user's home is a name like any other.

    raises : ConfigError where it has a NUL byte, which no path can have
    """
    if "\0" in str(path):
        raise ConfigError(f"{str(path)!r}: not a path: it has a NUL byte")
    try:
        return Path(path).expanduser()
    except RuntimeError:
        return Path(path)


def _yaml_names(folder: Traversable | None) -> list[str]:
    return sorted(f.name.removesuffix(".yaml") for f in folder.iterdir() if f.name.endswith(".yaml")) if folder else []


def _file(path: Any, files: tuple[str, ...], reading: Reading) -> tuple[dict[str, Any], str]:
    if str(path) in files:
        raise ConfigError(f"{path}: extends itself through {' → '.join(files)}")
    base = path.absolute().parent if isinstance(path, Path) else Path.cwd()
    return extended(read_yaml(path), base, str(path), (*files, str(path)), reading)


def read_yaml(path: Any) -> dict[str, Any]:
    """The keys at the top of a YAML file; raises ConfigError."""
    blocks = parsed(small_text(path, ConfigError, LARGEST), str(path))
    if blocks is not None and not isinstance(blocks, dict):
        raise ConfigError(f"{path}: expected keys with values at the top, got {type(blocks).__name__}")
    return blocks or {}


def extended(
    blocks: dict[str, Any], base: Path, where: str, files: tuple[str, ...], reading: Reading
) -> tuple[dict[str, Any], str]:
    """The blocks with their paths made absolute, over those of the preset or file they extend."""
    blocks = absolute(blocks, base, reading.paths)
    parent = blocks.pop("extends", None)
    if parent is None:
        return blocks, where
    source = reading.preset(str(parent)) or (base / expanded(str(parent))).resolve()
    if not source.is_file():
        presets = ", ".join(reading.preset_names) or "there are none"
        raise ConfigError(f"{where}: extends {parent!r}, which is neither a preset ({presets}) nor a file")
    below, _ = _file(source, files, reading)
    return merged(below, blocks), where


def merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """The keys of both, block by block; those above win."""
    both = dict(below)
    for key, value in above.items():
        is_block = isinstance(value, Mapping) and isinstance(both.get(key), Mapping)
        both[key] = merged(both[key], value) if is_block else value
    return both


def _moved(blocks: dict[str, Any], where: str, folder: Path) -> tuple[dict[str, Any], str]:
    """The blocks that lie in an output folder: it is the output wherever it was moved, and a store in it moved with it."""
    was, store = blocks.get("output"), blocks.get("store")
    if isinstance(was, str) and isinstance(store, str) and Path(store).is_relative_to(was):
        blocks["store"] = str(folder / Path(store).relative_to(was))
    return {**blocks, "output": str(folder)}, where


def absolute(blocks: Mapping[str, Any], base: Path, paths: Paths) -> dict[str, Any]:
    """Paths are relative to the file that names them."""

    def absolute(path: str) -> str:
        way = base / expanded(path)
        plain = Path(os.path.normpath(way))
        return str(plain if _is_same(plain, way) else way)

    return with_paths(blocks, paths, absolute)


def _is_same(a: Path, b: Path) -> bool:
    """Whether two ways lead to the same place: where a link stands between, its name does not say."""
    try:
        return a.resolve() == b.resolve()
    except (OSError, ValueError, RuntimeError):
        return False


def with_paths(blocks: Mapping[str, Any], paths: Paths, change: Callable[[str], str]) -> dict[str, Any]:
    """The blocks with every path in them changed; the address of a service is none."""
    changed = dict(blocks)
    for keys in [("output",), ("store",), *((task, *keys) for task in blocks for keys in paths.get(task, ()))]:
        changed = _with_path(changed, keys, change)
    return changed


def _with_path(blocks: Mapping[str, Any], keys: Sequence[str], change: Callable[[str], str]) -> dict[str, Any]:
    changed = dict(blocks)
    value = changed.get(keys[0])
    if len(keys) > 1 and isinstance(value, Mapping):
        changed[keys[0]] = _with_path(value, keys[1:], change)
    elif len(keys) > 1 and isinstance(value, list):
        changed[keys[0]] = [_with_path(each, keys[1:], change) if isinstance(each, Mapping) else each for each in value]
    elif len(keys) == 1 and isinstance(value, str) and value and "://" not in value:
        changed[keys[0]] = change(value)
    return changed
