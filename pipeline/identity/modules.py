"""The modules of some packages by their texts, and which definitions a name in them stands for."""

import ast
import builtins
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from kinetree.pipeline.identity.bindings import Target, imported_by, statements_in
from kinetree.pipeline.identity.names import Names, Use
from kinetree.pipeline.identity.statements import Module, Statement

Definition = tuple[str, str]
"""A module, and a name that it binds; EVERYTHING for all of it, STATEMENTS for what is no definition, IMPORTS for what is
listed together because it has no content of its own."""
EVERYTHING, STATEMENTS, IMPORTS = "*", "(statements)", "(imports)"
PACKAGE = ".__init__"
"""How the text of a package itself is called in the mapping of texts, so that a package is known from a module."""


@dataclass(eq=False)
class Modules:
    """The modules of some packages, by their texts; a package's own text is called `package.__init__`."""

    texts: Mapping[str, str]
    _modules: dict[str, Module] = field(default_factory=dict, init=False)
    _imports: dict[str, tuple[str, ...]] = field(default_factory=dict, init=False)
    _resolved: dict[tuple[str, str, tuple[str, ...]], frozenset[Definition]] = field(default_factory=dict, init=False)
    _asked: list[tuple[str, str, tuple[str, ...]]] = field(default_factory=list, init=False)

    def module(self, name: str) -> Module:
        """One module, read once."""
        if name not in self._modules:
            is_package = f"{name}{PACKAGE}" in self.texts
            text = self.texts.get(f"{name}{PACKAGE}" if is_package else name)
            if text is None:
                raise ModuleNotFoundError(f"no source for module {name!r}; its code cannot be identified", name=name)
            self._modules[name] = Module(name, text, is_package=is_package)
        return self._modules[name]

    def knows(self, name: str) -> bool:
        """Whether `name` is a module of ours."""
        return name in self.texts or f"{name}{PACKAGE}" in self.texts

    def imported(self, module: str) -> frozenset[str]:
        """The modules that importing `module` can import, packages on the way included."""
        modules: dict[str, None] = {}
        waiting = [module]
        while waiting:
            name = waiting.pop()
            if name not in modules and self.knows(name):
                modules[name] = None
                waiting += (*self.imports(name), name.rpartition(".")[0])
        return frozenset(modules)

    def imports(self, module: str) -> tuple[str, ...]:
        """The modules of ours that a module's import statements name, wherever in it they stand."""
        if module not in self._imports:
            here = self.module(module)
            targets = [
                target
                for node in _every_statement(here.tree.body)
                if isinstance(node, ast.Import | ast.ImportFrom)
                for _, target in _whole_targets(node, here)
            ]
            names = [f"{m}.{n}" if n and self.knows(f"{m}.{n}") else m for m, n in targets]
            self._imports[module] = tuple(dict.fromkeys(n for n in names if self.knows(n)))
        return self._imports[module]

    @cached_property
    def _namespaces(self) -> frozenset[str]:
        """The packages around ours, which have no text."""
        names = {name.removesuffix(PACKAGE) for name in self.texts}
        above = {".".join(name.split(".")[:n]) for name in names for n in range(1, name.count(".") + 1)}
        return frozenset(above - names)

    def import_order(self, module: str) -> list[str]:
        """The modules that importing `module` imports, in the order in which their statements are run."""
        order: dict[str, None] = {}
        begun: set[str] = set()
        waiting = [module]
        while waiting:
            name = waiting[-1]
            below = [m for m in (name.rpartition(".")[0], *self.imports(name)) if m not in begun and self.knows(m)]
            begun.add(name)
            if below:
                waiting.append(below[0])
            else:
                order[waiting.pop()] = None
        return list(order)

    def parts(self, one: Definition) -> list[Statement]:
        here = self.module(one[0])
        if one[1] == STATEMENTS:
            return [s for s in here.statements if s.kind == "effect"]
        return here.bindings.get(one[1], [])

    def is_import(self, one: Definition) -> bool:
        parts = self.parts(one)
        return bool(parts) and all(part.kind == "import" for part in parts)

    def named(self, here: Module, names: Names) -> set[Definition]:
        """The definitions that names stand for."""
        definitions = {one for use in names.uses for one in self.meant(here, use, names)}
        if names.is_dynamic:
            definitions.add((here.name, EVERYTHING))
            for text in (t for t in names.strings if "." in t):
                named = [m for m in (t.removesuffix(PACKAGE) for t in self.texts) if m == text or m.startswith(text)]
                definitions |= {(m, EVERYTHING) for m in named if m == text or text.endswith(".")}
        return definitions

    def meant(self, here: Module, use: Use, names: Names) -> Iterable[Definition]:
        if use.targets:
            return {one for target in use.targets for one in self._imported(target, use.attributes)}
        if use.name not in here.bindings and use.name in names.bound_in_classes:
            return ()
        return self.resolve(here.name, use.name, use.attributes)

    def resolve(self, module: str, name: str, attributes: tuple[str, ...]) -> frozenset[Definition]:
        """The definitions that `name.attribute.attribute…` stands for in a module."""
        asked = (module, name, attributes)
        if asked in self._resolved or asked in self._asked:
            return self._resolved.get(asked, frozenset())
        self._asked.append(asked)
        here = self.module(module)
        definitions: set[Definition] = set()
        if name in here.bindings:
            definitions.add((module, name))
            targets = [s.target for s in here.bindings[name] if s.target is not None]
            definitions |= {one for target in targets for one in self._imported(target, attributes)}
        elif here.starred:
            definitions.add((module, EVERYTHING))
        elif "__getattr__" in here.bindings and not hasattr(builtins, name):
            definitions.add((module, "__getattr__"))
        elif not hasattr(builtins, name) and not (name.startswith("__") and name.endswith("__")):
            definitions.add((module, EVERYTHING))
        self._asked.pop()
        if not self._asked:  # inside, a ring of imports may have cut the answer short
            self._resolved[asked] = frozenset(definitions)
        return frozenset(definitions)

    def _imported(self, target: Target, attributes: tuple[str, ...]) -> set[Definition]:
        """The definitions that an import's target, with attributes after it, stands for."""
        module, name = target
        chain = attributes if name is None else (name, *attributes)
        if not self.knows(module):
            inner = f"{module}.{chain[0]}" if chain else ""
            return self._imported((inner, None), chain[1:]) if self.knows(inner) or inner in self._namespaces else set()
        if not chain:
            return {(module, EVERYTHING)}
        definitions: set[Definition] = set()
        inner, here = f"{module}.{chain[0]}", self.module(module)
        if chain[0] in here.bindings:
            definitions |= self.resolve(module, chain[0], chain[1:])
        if self.knows(inner) and (len(chain) > 1 or not definitions):
            definitions |= self._imported((inner, None), chain[1:])
        return definitions or {*self.resolve(module, chain[0], chain[1:])} or {(module, EVERYTHING)}


def _every_statement(body: Sequence[ast.AST]) -> Iterator[ast.AST]:
    """The statements of a module in their order, those in functions and classes included."""
    for node in statements_in(body):
        yield node
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield from _every_statement(node.body)


def _whole_targets(node: ast.Import | ast.ImportFrom, here: Module) -> Iterator[tuple[str, Target]]:
    """What an import statement imports: `import a.b` is a.b, whatever it binds."""
    if isinstance(node, ast.Import):
        yield from ((alias.name, (alias.name, None)) for alias in node.names)
    else:
        yield from imported_by(node, here.name, is_package=here.is_package)
