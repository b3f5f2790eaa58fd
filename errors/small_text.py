"""Small text files that people write, read whole or refused: none can fill the memory, wait for ever or break a parser."""

import io
import json
import os
import re
import stat
from typing import Any

import yaml

from kinetree.errors import InputError

LARGEST = 256 * 2**20
"""Bytes of the largest text that is read: joints of a hundred thousand frames fit."""
DEPTH = 100
"""Lists and mappings within each other that a text may have."""
VALUES = 10**6
"""Values that a YAML text may stand for, its aliases written out."""
_DIGITS = 308
"""Digits of the longest whole number, beyond which no float holds it."""


def small_text(path: Any, error: type[InputError] = InputError, largest: int = LARGEST) -> str:
    """The text of a regular file of at most `largest` bytes in UTF-8, with or without a byte order mark.

    path   : path of a file, or a file of an installed package
    raises : `error` that names the path and what to do
    """
    try:
        with _opened(path, error) as file:
            data: bytes = file.read(largest + 1)
    except OSError as problem:
        raise error(f"{path}: cannot be read: {problem.strerror or problem}") from None
    except ValueError as problem:  # a NUL byte in the path
        raise error(f"{str(path)!r}: not the path of a file: {problem}") from None
    if len(data) > largest:
        raise error(f"{path}: more than {largest} bytes; no such file is as large, is it another one?")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise error(f"{path}: not a text file in UTF-8: byte {problem.start} is {data[problem.start]:#04x}") from None


def small_json(text: str, where: str, error: type[InputError] = InputError) -> Any:
    """The value that a JSON text holds.

    where  : what messages call the text
    raises : `error` where it is no JSON, is nested beyond reason or has a whole number that no float holds
    """
    try:
        return json.loads(text, parse_int=_whole)
    except ValueError as problem:
        raise error(f"{where}: not JSON: {problem}") from None
    except RecursionError:
        raise error(f"{where}: not JSON that can be read: its lists are nested too deeply") from None


class BoundedLoader(yaml.SafeLoader):
    """Plain YAML of bounded depth and size, so that a few lines of aliases cannot stand for more than memory holds."""

    def __init__(self, stream: Any) -> None:
        super().__init__(stream)
        self._sizes: dict[yaml.Node, int] = {}
        self._depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """Composes a node and counts the values that it stands for."""
        mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
        is_alias = self.check_event(yaml.AliasEvent)
        self._depth += 1
        if self._depth > DEPTH:
            raise yaml.composer.ComposerError(None, None, "its values are nested too deeply", mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if node is None:
            return None
        if is_alias and node not in self._sizes:
            raise yaml.composer.ComposerError(None, None, "an alias stands for a value that contains it", mark)
        if not is_alias:
            self._sizes[node] = 1 + sum(self._sizes[part] for part in _parts(node))
        if self._sizes[node] > VALUES:
            problem = f"its aliases written out are more than {VALUES} values"
            raise yaml.composer.ComposerError(None, None, problem, mark)
        return node

    def construct_yaml_int(self, node: yaml.ScalarNode) -> int:
        """A whole number that a float can hold."""
        value = int(super().construct_yaml_int(node))
        if abs(value) >= 10**_DIGITS:
            raise yaml.constructor.ConstructorError(None, None, f"a number of more than {_DIGITS} digits", node.start_mark)
        return value


BoundedLoader.add_constructor("tag:yaml.org,2002:int", BoundedLoader.construct_yaml_int)


def small_yaml(text: str, where: str, error: type[InputError] = InputError, loader: type[BoundedLoader] = BoundedLoader) -> Any:
    """The plain value that a YAML text holds.

    where  : what messages call the text
    loader : how scalars become values
    raises : `error` with the line, where it is no YAML, asks for anything but plain values, or is larger or deeper than reason
    """
    try:
        return yaml.load(text, Loader=loader)
    except yaml.YAMLError as problem:
        mark = getattr(problem, "problem_mark", None)
        line = f", line {mark.line + 1}" if mark else ""
        what = getattr(problem, "problem", None) or " ".join(str(problem).split())
        raise error(f"{where}{line}: not valid YAML: {what}") from None
    except RecursionError:
        raise error(f"{where}: not valid YAML: its values are nested too deeply") from None
    except (ValueError, TypeError, AttributeError, LookupError, OverflowError) as problem:  # a scalar that its tag does not fit
        raise error(
            f"{where}: not valid YAML: {_brief(problem)}; put texts that look like dates or numbers in quotes"
        ) from None


def json_only(value: Any, where: str, error: type[InputError] = InputError) -> Any:
    """The value, if it has nothing but what JSON can hold.

    raises : `error` that names the first key that is no text, or the first date, set or other thing
    """
    if isinstance(value, dict):
        for key, part in value.items():
            if not isinstance(key, str):
                raise error(f"{where}: the key {key!r} is no text; put it in quotes")
            json_only(part, f"{where}: {key}", error)
    elif isinstance(value, list):
        for part in value:
            json_only(part, where, error)
    elif not isinstance(value, str | bool | int | float | None):
        raise error(f"{where}: {value!r} is of type {type(value).__name__}; put texts that look like dates in quotes")
    return value


def _opened(path: Any, error: type[InputError]) -> Any:
    """The file, opened without waiting for anybody to write into it."""
    if not isinstance(path, str | os.PathLike):
        return path.open("rb")  # within a package
    file = io.FileIO(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC))
    if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        file.close()
        raise error(f"{path}: not a regular file")
    return io.BufferedReader(file)


def _parts(node: yaml.Node) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        return [part for pair in node.value for part in pair]
    return list(node.value) if isinstance(node, yaml.SequenceNode) else []


def _whole(digits: str) -> int:
    if len(digits) > _DIGITS:
        raise ValueError(f"a number of {len(digits)} digits, {digits[:20]}…")
    return int(digits)


def _brief(problem: Exception) -> str:
    is_told = isinstance(problem, ValueError)
    return re.sub(r"[;:] use sys\..*", "", str(problem)) if is_told else "a value is not what its tag says"
