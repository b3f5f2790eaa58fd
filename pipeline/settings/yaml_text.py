"""YAML as people write it in configurations: 10:50:2 is a range of frames and not a number to base sixty."""

import re
from typing import Any

import yaml

from kinetree.errors import ConfigError
from kinetree.errors.small_text import BoundedLoader, small_yaml

_INT = "tag:yaml.org,2002:int"
_FLOAT = "tag:yaml.org,2002:float"
_DECIMAL = re.compile(r"[-+]?(?:0|[1-9][0-9_]*|0x[0-9a-fA-F][0-9a-fA-F_]*)")
_POINT = re.compile(r"[-+]?(?:[0-9][0-9_]*\.[0-9_]*(?:[eE][-+]?[0-9]+)?|\.[0-9]+(?:[eE][-+]?[0-9]+)?|[0-9]+[eE][-+]?[0-9]+)"
                    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")  # fmt: skip


class _Loader(BoundedLoader):
    """Plain values only, each key once; numbers as in YAML 1.2."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Refuses a key that is there twice, of which one would silently be lost."""
        names: set[str] = set()
        for name, _ in node.value:
            if isinstance(name, yaml.ScalarNode) and name.tag != "tag:yaml.org,2002:merge":
                if name.value in names:
                    problem = f"key {name.value!r} is there twice"
                    raise yaml.constructor.ConstructorError(None, None, problem, name.start_mark)
                names.add(name.value)
        return super().construct_mapping(node, deep)


_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in rows if tag not in (_INT, _FLOAT)]
    for first, rows in yaml.SafeLoader.yaml_implicit_resolvers.items()
}


class _Dumper(yaml.SafeDumper):
    """Quotes a text that would be read back as a number of YAML 1.2, such as 0E0."""


for _kind in (_Loader, _Dumper):
    _kind.add_implicit_resolver(_INT, re.compile(f"^(?:{_DECIMAL.pattern})$"), list("-+0123456789"))
    _kind.add_implicit_resolver(_FLOAT, re.compile(f"^(?:{_POINT.pattern})$"), list("-+0123456789."))


def parsed(text: str, where: str) -> Any:
    """The plain value that a YAML text holds.

    raises : ConfigError with the line, where it is no YAML, asks for anything but plain values, or is too large or deep
    """
    return small_yaml(text, where, ConfigError, _Loader)


def dumped(value: Any, **how: Any) -> str:
    """A plain value as a YAML text from which `parsed` makes the same value; `how` as of `yaml.dump`."""
    return str(yaml.dump(value, Dumper=_Dumper, **how))
