"""A module as its statements: what each binds, which names it uses, and its syntax as text without what changes nothing."""

import ast
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from kinetree.pipeline.identity.bindings import Target, bound_by, imported_by
from kinetree.pipeline.identity.names import Names, names_of

Kind = Literal["function", "class", "value", "import", "effect"]
_UNCHANGEABLE = (
    "bool bytes complex float frozenset int range str tuple TypeVar NewType ParamSpec compile uint8 uint32 uint64 int64"
)
FIXED_CALLS = frozenset(_UNCHANGEABLE.split())
"""What makes a value that nothing can change in place."""
TASK = ("kinetree.pipeline.task", "task")
LIMITS = ("retries", "timeout", "memory")
"""What the declaration of a task says of where and how often it runs, which changes nothing that it computes."""


@dataclass(eq=False)
class Statement:
    """A statement at the top level of a module, or below its conditions, or one name of an import."""

    module: "Module"
    kind: Kind
    names: tuple[str, ...]
    nodes: tuple[ast.AST, ...]
    """The conditions under which it stands, then itself."""
    target: Target | None = None
    """What an import binds."""

    @cached_property
    def uses(self) -> Names:
        """The names it uses."""
        nodes = self.nodes[:-1] if self.kind == "import" else self.nodes
        return self._names_of(nodes)

    def _names_of(self, nodes: Sequence[ast.AST]) -> Names:
        module = self.module
        return names_of(nodes, module.name, is_package=module.is_package, walrus=module.has_walrus)

    @cached_property
    def at_import(self) -> Names:
        """The names it uses when the module is imported, as far as that may change other definitions."""
        node = self.nodes[-1]
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            body = [s for s in node.body if isinstance(s, ast.Expr | ast.Assign | ast.Delete)] if self.kind == "class" else []
            changing = [s for s in body if not isinstance(s, ast.Assign) or any(not _is_name(t) for t in s.targets)]
            nodes = [ast.FunctionDef("", _NOTHING, [], node.decorator_list), *changing]
            return self._names_of(nodes)
        return self.uses

    @cached_property
    def syntax(self) -> list[str]:
        """Its syntax tree as text, without what cannot change a result."""
        parts = [syntax(node) for node in self.nodes]
        if self.target is not None:
            parts[-1] = f"import {(self.names[0], *self.target)}"
        return parts

    @cached_property
    def is_fixed(self) -> bool:
        """Whether it is an import, or a constant that nothing can change in place."""
        node = self.nodes[-1]
        if isinstance(node, ast.Assign | ast.AnnAssign):
            return node.value is None or _is_fixed(node.value)
        return self.kind == "import"

    @cached_property
    def is_registry(self) -> bool:
        """Whether it is a class whose body holds something that may grow."""
        node = self.nodes[-1]
        values = [s.value for s in getattr(node, "body", ()) if isinstance(s, ast.Assign | ast.AnnAssign)]
        return self.kind == "class" and any(isinstance(v, _GROWING) or _called(v) in _MAKERS for v in values)


class Module:
    """One module's statements, by the names they bind."""

    def __init__(self, name: str, text: str, *, is_package: bool) -> None:
        self.name, self.is_package = name, is_package
        self.tree = ast.parse(text)
        self.has_globals, self.has_walrus = (
            re.search(r"^\s*global\s+\w+\s*(,|$)|[:;]\s*global\s", text, re.MULTILINE) is not None,
            ":=" in text,
        )
        self.statements = list(self._statements(self.tree.body, ()))
        self.bindings: dict[str, list[Statement]] = {}
        self.starred = tuple(s.target[0] for s in self.statements if s.target and s.target[1] == "*")
        for statement in self.statements:
            for bound in statement.names:
                self.bindings.setdefault(bound, []).append(statement)
        for statement in self.statements:
            self._drop_limits(statement.nodes[-1])

    def _drop_limits(self, node: ast.AST) -> None:
        """Takes out of a task's declaration what cannot change a result, so that nobody reads it."""
        for call in getattr(node, "decorator_list", ()):
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Name):
                if [s.target for s in self.bindings.get(call.func.id, ())] == [TASK]:
                    call.keywords = [keyword for keyword in call.keywords if keyword.arg not in LIMITS]

    def _statements(self, body: Sequence[ast.stmt], above: tuple[ast.AST, ...]) -> Iterator[Statement]:
        for node in body:
            if isinstance(node, ast.If):
                if _is_main(node.test):
                    yield from (s for s in self._statements(node.body, (*above, node.test)) if s.kind != "effect")
                else:
                    yield from self._statements(node.body, (*above, node.test))
                yield from self._statements(node.orelse, (*above, ast.Not(), node.test))
            elif isinstance(node, ast.Import | ast.ImportFrom):
                for name, target in imported_by(node, self.name, is_package=self.is_package):
                    yield Statement(self, "import", (name,), (*above, node), target)
            elif not is_docstring(node) and not isinstance(node, ast.Pass | ast.Raise):
                yield from self._one(node, above)

    def _one(self, node: ast.stmt, above: tuple[ast.AST, ...]) -> Iterator[Statement]:
        pairs = _unpacked(node)
        if pairs:
            yield from (Statement(self, "value", (target.id,), (*above, part)) for target, part in pairs)
            return
        inside = ast.walk(node) if self.has_globals else ()
        elsewhere = {n for inner in inside if isinstance(inner, ast.Global) for n in inner.names}
        names = tuple(sorted(bound_by(node, walrus=self.has_walrus) | elsewhere))
        kind: Kind = "value" if names else "effect"
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            kind = "class" if isinstance(node, ast.ClassDef) else "function"
        yield Statement(self, kind, names, (*above, node))


def syntax(node: ast.AST) -> str:
    """The tree as text that no other tree has: no positions, no bare strings (docstrings), no field that is empty.

    Fields that are empty are left out because Python versions differ in which empty fields a node has.
    """
    pieces: list[str] = []
    _write(node, pieces.append)
    return "".join(pieces)


def _write(node: ast.AST, put: Callable[[str], object]) -> None:
    put(f"{type(node).__name__}(")
    for name in node._fields:
        value = getattr(node, name, None)
        if isinstance(value, ast.AST):
            put(f"{name}=")
            _write(value, put)
        elif isinstance(value, list):
            items = [i for i in value if not is_docstring(i)]
            if items:
                put(f"{name}=[")
                for item in items:
                    _write(item, put) if isinstance(item, ast.AST) else put(f"{item!r},")
                put("]")
        elif value is not None:
            put(f"{name}={type(value).__name__} {value!r},")
    put(")")


def is_docstring(node: Any) -> bool:
    """A string that stands alone as a statement: it documents and cannot change a result."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


_NOTHING = ast.arguments(posonlyargs=[], args=[], kwonlyargs=[], kw_defaults=[], defaults=[])
_GROWING = (ast.List, ast.Dict, ast.Set, ast.ListComp, ast.DictComp, ast.SetComp)
_MAKERS = frozenset(
    [
        "list",
        "dict",
        "set",
        "defaultdict",
        "OrderedDict",
        "Counter",
        "deque",
        "WeakSet",
        "WeakKeyDictionary",
        "WeakValueDictionary",
    ]
)


def _called(node: ast.AST | None) -> str:
    """The last word of what an expression calls."""
    if not isinstance(node, ast.Call):
        return ""
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def _is_fixed(node: ast.AST) -> bool:
    if isinstance(node, ast.Tuple | ast.UnaryOp | ast.BinOp | ast.JoinedStr | ast.FormattedValue | ast.Starred):
        below = [c for c in ast.iter_child_nodes(node) if isinstance(c, ast.expr)]
        return all(_is_fixed(c) for c in below)
    return isinstance(node, ast.Constant) or _called(node) in FIXED_CALLS


def _is_name(node: ast.AST) -> bool:
    return isinstance(node, ast.Name)


def _is_main(test: ast.AST) -> bool:
    """Whether it is `__name__ == "__main__"`, which holds for nothing that is imported."""
    return ast.unparse(test) in ("__name__ == '__main__'", "'__main__' == __name__")


def _unpacked(node: ast.stmt) -> list[tuple[ast.Name, ast.stmt]]:
    """`a, b = x, y` as `a = x` and `b = y`; empty where it is anything else."""
    if not isinstance(node, ast.Assign) or len(node.targets) != 1:
        return []
    target, value = node.targets[0], node.value
    if not (isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and len(target.elts) == len(value.elts)):
        return []
    pairs = list(zip(target.elts, value.elts, strict=True))
    if any(isinstance(v, ast.Starred) for _, v in pairs):
        return []
    names = [t for t in target.elts if isinstance(t, ast.Name)]
    if len(names) < len(pairs):
        return []
    return [(n, ast.Assign(targets=[n], value=v)) for n, (_, v) in zip(names, pairs, strict=True)]
