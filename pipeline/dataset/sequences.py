"""Which sequences a data set has: patterns looked up in folders, a name for each from its path."""

import glob
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from kinetree.errors import ConfigError
from kinetree.pipeline.settings.blocks import expanded

WILD = re.compile(r"[*?\[]")
FIELDS = ("stem", "name", "parent", "grandparent")
NAME = "{name}"
"""Stands in the path of the output for the sequence's name."""


def sequences(entry: Any, template: Any, base: Path, where: str) -> tuple[dict[str, str], list[str]]:
    """The input of every sequence by name, sorted by name, and remarks on patterns that match nothing.

    entry    : a pattern, a list of patterns and paths, or a mapping from name to the path or pattern of one sequence's frames
    template : how a name is made of a path, e.g. "{parent}-{stem}"
    base     : the folder to which paths are relative
    where    : the file, for messages
    raises   : ConfigError
    """
    if isinstance(entry, Mapping):
        named = {_named(name, f"{where}: sequences"): _text(path, f"{where}: sequences.{name}") for name, path in entry.items()}
        if not named:
            raise ConfigError(f"{where}: sequences: expected at least one name with a path, found none")
        return {name: _absolute(path, base) for name, path in sorted(named.items())}, []
    patterns = [entry] if isinstance(entry, str) else entry
    if not isinstance(patterns, Sequence) or isinstance(patterns, bytes) or not patterns:
        raise ConfigError(
            f"{where}: sequences: expected a pattern such as takes/*, a list of patterns and paths, or names with paths, got"
            f" {entry!r}"
        )
    matched, empty = _matched([_absolute(_text(p, f"{where}: sequences"), base) for p in patterns])
    if not matched:
        raise ConfigError(
            f"{where}: sequences: nothing matches {', '.join(empty)}; check the path, which is relative to the folder of this"
            " file: a pattern matches one folder or file for every sequence"
        )
    named_paths: dict[str, str] = {}
    for path in matched:
        name = _named(_filled(template, path, where), f"{where}: name, made of {path}")
        if named_paths.setdefault(name, path) != path:
            raise ConfigError(
                f"{where}: {named_paths[name]} and {path} are both named {name!r}; tell them apart with name:"
                ' "{parent}-{stem}", or list them with names'
            )
    return dict(sorted(named_paths.items())), [f"sequences: nothing matches {pattern}" for pattern in empty]


def frames_taken_for_sequences(inputs: Mapping[str, str]) -> list[str]:
    """A remark on sequences none of which could be read: they may be the frames of one.

    inputs : path by name
    """
    folders = {Path(path).parent for path in inputs.values() if Path(path).is_file()}
    if len(inputs) < 2 or len(folders) != 1 or not all(Path(path).is_file() for path in inputs.values()):
        return []
    folder = folders.pop()
    remark = f"sequences: each of {len(inputs)} files in {folder} is taken for a sequence"
    return [f"{remark}; if they are the frames of one, give the folder: sequences: [{folder}]"]


def matches(path: Path, pattern: str) -> bool:
    """Whether a pattern, looked up in folders, would find this path."""
    return _match(path.parts, Path(pattern).parts)


def chosen(names: Iterable[str], patterns: Sequence[str]) -> list[str]:
    """The names that match one of the patterns, or all where there is no pattern; raises ConfigError where none does."""
    every = list(names)
    matching = [name for name in every if not patterns or any(fnmatchcase(name, pattern) for pattern in patterns)]
    if patterns and not matching:
        listed = ", ".join(every[:6]) + (f" and {len(every) - 6} more" if len(every) > 6 else "")
        raise ConfigError(f"--only {' '.join(patterns)}: no sequence has such a name; there are: {listed}")
    return matching


def _matched(patterns: Sequence[str]) -> tuple[list[str], list[str]]:
    """The paths that patterns match, each once, and the patterns that match nothing; a plain path stands for itself."""
    inputs: dict[str, None] = {}
    empty: list[str] = []
    for pattern in patterns:
        is_plain = not WILD.search(pattern) or "://" in pattern or Path(pattern).exists()
        paths = [pattern] if is_plain else sorted(glob.glob(pattern, recursive=True))  # noqa: PTH207 - a pattern of any root
        if not paths:
            empty.append(pattern)
        inputs.update(dict.fromkeys(path if "://" in path else os.path.normpath(path) for path in paths))
    return list(inputs), empty


def _match(parts: Sequence[str], pattern: Sequence[str]) -> bool:
    if not pattern:
        return not parts
    if pattern[0] == "**":
        return any(_match(parts[n:], pattern[1:]) for n in range(len(parts) + 1))
    return bool(parts) and fnmatchcase(parts[0], pattern[0]) and _match(parts[1:], pattern[1:])


def _filled(template: Any, path: str, where: str) -> str:
    """The name that a template makes of a path; {stem} is the last part without the ending of a file."""
    if not isinstance(template, str) or not re.search(r"\{(stem|name)\}", template):
        raise ConfigError(f'{where}: name: expected a text with {{stem}}, such as "{{parent}}-{{stem}}", got {template!r}')
    place = Path(path)
    values = {
        "stem": place.name if place.is_dir() else place.stem,
        "name": place.name,
        "parent": place.parent.name,
        "grandparent": place.parent.parent.name,
    }
    unknown = [field for field in re.findall(r"\{(.*?)\}", template) if field not in values]
    if unknown:
        raise ConfigError(f"{where}: name: no such field {{{unknown[0]}}}; there are: {', '.join(f'{{{f}}}' for f in FIELDS)}")
    return re.sub(r"\{(\w+)\}", lambda field: values[field.group(1)], template)


def _named(name: Any, where: str) -> str:
    text = str(name)
    if not text or text in (".", "..") or "/" in text or "\0" in text or text.startswith(".") or not text.isprintable():
        raise ConfigError(f"{where}: {text!r} cannot be a sequence's name, which is also its folder's; name it otherwise")
    return text


def _text(path: Any, where: str) -> str:
    if not isinstance(path, str) or not path:
        raise ConfigError(f"{where}: expected a path or a pattern, got {path!r}; put it in quotes if it is one")
    return path


def _absolute(path: str, base: Path) -> str:
    """The path below the folder of the file that names it; a slash at its end, which asks for folders alone, stays."""
    if "://" in path:
        return path
    plain = os.path.normpath(base / expanded(path))
    return f"{plain}/" if path.endswith("/") else plain
