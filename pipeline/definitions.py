"""Which definitions a function can reach by name, through all modules of the packages that count, by their text alone.

A *definition* is what the top level of a module binds: a function, a class, a constant, one name of an import. Everything
that binds a name counts for it, in order. What cannot be resolved counts a whole module. A statement that binds nothing, or
that changes what another binds (`TABLE.update(…)`, a decorator that registers), counts where it can change what is reached.

Where a guess is needed it is that more is reached, never less.
"""

import ast
import builtins
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from kinetree.pipeline.names import CALLED, HANDED, STORED, Names, Target, Use, imported_by, names_of, statements_in
from kinetree.pipeline.statements import Module, Statement

Definition = tuple[str, str]
"""A module, and a name that it binds; EVERYTHING for all of it, STATEMENTS for what is no definition, IMPORTS for what is
told together because it has no content of its own."""
EVERYTHING, STATEMENTS, IMPORTS = "*", "(statements)", "(imports)"
PACKAGE = ".__init__"
"""How the text of a package itself is called in the mapping of texts, so that a package is known from a module."""


@dataclass(eq=False)
class Code:
    """The modules of some packages, by their texts; a package's own text is called `package.__init__`."""

    texts: Mapping[str, str]
    harmless: tuple[str, ...] = ()
    """Packages that may not change a result: what a module hands to their functions changes nothing that is reached."""
    digests: dict[Definition, str] = field(default_factory=dict)
    """Of definitions, for whoever digests their syntax."""
    _modules: dict[str, Module] = field(default_factory=dict)
    _imports: dict[str, tuple[str, ...]] = field(default_factory=dict)
    _edges: dict[Definition, frozenset[Definition]] = field(default_factory=dict)
    _effects: dict[frozenset[str], "list[_Effect]"] = field(default_factory=dict)
    _resolved: dict[tuple[str, str, tuple[str, ...]], frozenset[Definition]] = field(default_factory=dict)
    _asked: list[tuple[str, str, tuple[str, ...]]] = field(default_factory=list)

    def reached(self, module: str, name: str) -> dict[Definition, list[list[str]]]:
        """What the definition `name` of `module` reaches, itself included: the plain syntax of each, sorted.

        raises : ModuleNotFoundError where there is no text of `module`
        """
        self.module(module)
        found: set[Definition] = set()
        counted: set[Statement] = set()
        modules = self.imported(module)
        waiting = set(self._resolve(module, name, ()))
        while waiting:
            self._reach(found, waiting)
            waiting = set()
            for effect in self._effects_in(modules):
                if effect.statement not in counted and effect.counts(found):
                    counted.add(effect.statement)
                    waiting |= effect.reached
        told = {one: self._syntax(one) for one in found if one[1] not in (EVERYTHING, STATEMENTS) and not self._is_import(one)}
        for one in sorted(found):
            if self._is_import(one):
                told.setdefault((one[0], IMPORTS), []).extend(self._syntax(one))
        return dict(sorted((told | self._orders(module, found, counted)).items()))

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
        found: dict[str, None] = {}
        waiting = [module]
        while waiting:
            name = waiting.pop()
            if name not in found and self.knows(name):
                found[name] = None
                waiting += (*self.imports(name), name.rpartition(".")[0])
        return frozenset(found)

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

    def _reach(self, found: set[Definition], waiting: Iterable[Definition]) -> None:
        """Adds to `found` what definitions reach by name."""
        rest = [one for one in waiting if one not in found]
        while rest:
            one = rest.pop()
            if one not in found:
                found.add(one)
                rest.extend(self._next(one) - found)

    def _next(self, one: Definition) -> frozenset[Definition]:
        """What a definition names."""
        if one not in self._edges:
            module, name = one
            here = self.module(module)
            found: set[Definition] = set()
            if name == EVERYTHING:
                found |= {(module, bound) for bound in here.bindings if bound != EVERYTHING} | {(module, STATEMENTS)}
            found |= {(starred, EVERYTHING) for starred in here.starred if self.knows(starred)}
            for statement in self._parts(one):
                found |= self._named(here, statement.uses)
            self._edges[one] = frozenset(found)
        return self._edges[one]

    def _parts(self, one: Definition) -> list[Statement]:
        here = self.module(one[0])
        if one[1] == STATEMENTS:
            return [s for s in here.statements if s.kind == "effect"]
        return here.bindings.get(one[1], [])

    def _named(self, here: Module, names: Names) -> set[Definition]:
        """The definitions that names stand for."""
        found = {one for use in names.uses for one in self._of(here, use, names)}
        if names.is_dynamic:
            found.add((here.name, EVERYTHING))
            for text in (t for t in names.strings if "." in t):
                named = [m for m in (t.removesuffix(PACKAGE) for t in self.texts) if m == text or m.startswith(text)]
                found |= {(m, EVERYTHING) for m in named if m == text or text.endswith(".")}
        return found

    def _of(self, here: Module, use: Use, names: Names) -> Iterable[Definition]:
        if use.targets:
            return {one for target in use.targets for one in self._imported(target, use.attributes)}
        if use.name not in here.bindings and use.name in names.bound_in_classes:
            return ()
        return self._resolve(here.name, use.name, use.attributes)

    def _resolve(self, module: str, name: str, attributes: tuple[str, ...]) -> frozenset[Definition]:
        """The definitions that `name.attribute.attribute…` stands for in a module."""
        asked = (module, name, attributes)
        if asked in self._resolved or asked in self._asked:
            return self._resolved.get(asked, frozenset())
        self._asked.append(asked)
        here = self.module(module)
        found: set[Definition] = set()
        if name in here.bindings:
            found.add((module, name))
            targets = [s.target for s in here.bindings[name] if s.target is not None]
            found |= {one for target in targets for one in self._imported(target, attributes)}
        elif here.starred:
            found.add((module, EVERYTHING))
        elif "__getattr__" in here.bindings and not hasattr(builtins, name):
            found.add((module, "__getattr__"))
        elif not hasattr(builtins, name) and not (name.startswith("__") and name.endswith("__")):
            found.add((module, EVERYTHING))
        self._asked.pop()
        if not self._asked:  # inside, a ring of imports may have cut the answer short
            self._resolved[asked] = frozenset(found)
        return frozenset(found)

    def _imported(self, target: Target, attributes: tuple[str, ...]) -> set[Definition]:
        """The definitions that an import's target, with attributes after it, stands for."""
        module, name = target
        chain = attributes if name is None else (name, *attributes)
        if not self.knows(module):
            inner = f"{module}.{chain[0]}" if chain else ""
            return self._imported((inner, None), chain[1:]) if self.knows(inner) or inner in self._namespaces else set()
        if not chain:
            return {(module, EVERYTHING)}
        found: set[Definition] = set()
        inner, here = f"{module}.{chain[0]}", self.module(module)
        if chain[0] in here.bindings:
            found |= self._resolve(module, chain[0], chain[1:])
        if self.knows(inner) and (len(chain) > 1 or not found):
            found |= self._imported((inner, None), chain[1:])
        return found or {*self._resolve(module, chain[0], chain[1:])} or {(module, EVERYTHING)}

    def _syntax(self, one: Definition) -> list[list[str]]:
        return [part.syntax for part in self._parts(one)]

    def _orders(self, module: str, found: set[Definition], effects: set[Statement]) -> dict[Definition, list[list[str]]]:
        """Of every module in which it matters: the order of what is reached, with the statements that are no definitions."""
        effects = effects | {s for one in found if one[1] == STATEMENTS for s in self._parts(one)}
        told: dict[Definition, list[list[str]]] = {}
        for name in {one[0] for one in found} | {s.module.name for s in effects}:
            here = self.module(name)
            counted = [s for s in here.statements if s in effects or any((name, n) in found for n in s.names)]
            lines = [s for s in counted if s.kind != "import"]
            is_twice = any(len(here.bindings[n]) > 1 for s in lines for n in s.names)
            if is_twice or any(s in effects for s in counted):
                told[name, STATEMENTS] = [s.syntax if s.kind == "effect" else [*s.names] for s in lines]
        if len({s.module.name for s in effects}) > 1:
            told["", STATEMENTS] = [[m] for m in self._import_order(module) if any(s.module.name == m for s in effects)]
        return told

    def _import_order(self, module: str) -> list[str]:
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

    def _effects_in(self, modules: frozenset[str]) -> "list[_Effect]":
        """The statements of modules that can change what others define."""
        if modules not in self._effects:
            found = [e for m in sorted(modules) for s in self.module(m).statements if (e := self._effect(s)) is not None]
            self._effects[modules] = found
        return self._effects[modules]

    def _effect(self, statement: Statement) -> "_Effect | None":
        """What a statement can change when its module is imported; None where that is nothing but what it binds."""
        if statement.kind == "import" or self._is_harmless(statement):
            return None
        here, names = statement.module, statement.at_import
        own = {(here.name, name) for name in statement.names}
        changed = self._changed(here, names, handed=statement.kind == "effect") | self._subclassed(statement)
        named = self._named(here, names)
        below: set[Definition] = set()
        called = {one for call in names.uses if call.treated == CALLED for one in self._of(here, call, names)}
        self._reach(below, called if statement.kind != "effect" else named)
        parts = [part for one in below for part in self._parts(one)]
        changed |= self._handed(here, names, always=any(part.uses.stores_locally for part in parts))
        for part in parts:
            made = {(part.module.name, name) for name in part.names} if part.kind == "value" else set()
            changed |= self._changed(part.module, part.uses) - made
        always = False
        if statement.kind == "effect":
            defined = {one for one in named if not self._is_import(one)}
            changed |= defined
            always = not defined or any(self._is_outward(p.module, p.uses) for p in [statement, *parts])
        changed = self._with_contents(changed - own) - own
        reached = frozenset(own or named)
        return _Effect(statement, frozenset(changed), reached, always) if changed or always else None

    def _is_harmless(self, statement: Statement) -> bool:
        """Whether a statement only calls a function of a package that may not change a result."""
        node = statement.nodes[-1]
        if statement.kind != "effect" or not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)):
            return False
        function = node.value.func
        if not isinstance(function, ast.Name) or sum(isinstance(n, ast.Call) for n in ast.walk(node)) > 1:
            return False
        targets = [s.target for s in statement.module.bindings.get(function.id, ())]
        return bool(targets) and all(t is not None and f"{t[0]}.".startswith(self._harmless_stems) for t in targets)

    @cached_property
    def _harmless_stems(self) -> tuple[str, ...]:
        return tuple(f"{package}." for package in self.harmless)

    def _with_contents(self, changed: set[Definition]) -> set[Definition]:
        """Values with the values that they hold, which are changed through them."""
        found: set[Definition] = set()
        waiting = [*changed]
        while waiting:
            one = waiting.pop()
            if one not in found:
                found.add(one)
                for part in self._parts(one):
                    waiting += self._changed(part.module, part.uses) if part.kind == "value" else ()
        return found

    def _handed(self, here: Module, names: Names, *, always: bool) -> set[Definition]:
        """The definitions that are handed to functions which may change them: others' functions, or all functions."""
        found: set[Definition] = set()
        for call in names.calls:
            is_ours = any(not self._is_import(one) for one in self._of(here, call.called, names))
            for use in call.handed:
                told = [one for one in self._of(here, use, names) if not self._is_import(one)]
                found.update(one for one in told if (is_ours and always) or (not is_ours and self._can_change(one, use)))
        return found

    def _changed(self, here: Module, names: Names, *, handed: bool = True) -> set[Definition]:
        """The definitions that names are used to change in place, as far as one can see.

        handed : whether what is handed on, to whatever end, counts
        """
        found: set[Definition] = set()
        for use in names.uses:
            if use.treated > HANDED or (handed and use.treated == HANDED):
                for one in self._of(here, use, names):
                    if self._can_change(one, use):
                        found.add(one)
        return found

    def _can_change(self, one: Definition, use: Use) -> bool:
        parts = self._parts(one)
        if self._is_import(one):
            return False
        is_state = any(p.is_registry or (p.kind == "value" and not p.is_fixed) for p in parts)
        if use.treated == STORED:
            return True
        if use.treated == CALLED:
            is_method = bool(use.attributes) and use.attributes[-1] != one[1]
            return is_method and (is_state or any(p.kind == "function" for p in parts))
        return use.treated == HANDED and is_state

    def _is_import(self, one: Definition) -> bool:
        parts = self._parts(one)
        return bool(parts) and all(part.kind == "import" for part in parts)

    def _is_outward(self, here: Module, names: Names) -> bool:
        """Whether names are used to change what is no code of ours, such as a library's settings."""
        told = [[*self._of(here, use, names)] for use in names.outward]
        return any(found and all(self._is_import(one) for one in found) for found in told)

    def _subclassed(self, statement: Statement) -> set[Definition]:
        """The classes that learn of their subclasses, of which the statement makes one."""
        node = statement.nodes[-1]
        if not isinstance(node, ast.ClassDef):
            return set()
        found: set[Definition] = set()
        bases = names_of([*node.bases], statement.module.name, is_package=statement.module.is_package)
        for one in self._named(statement.module, bases):
            for part in self._parts(one):
                learns = part.kind == "class" and _learns(part.nodes[-1])
                found |= {one} if learns else set()
                found |= self._subclassed(part)
        return found


@dataclass(frozen=True, eq=False)
class _Effect:
    """A statement that changes what others define, and what counts where it does."""

    statement: Statement
    changed: frozenset[Definition]
    reached: frozenset[Definition]
    always: bool

    def counts(self, found: set[Definition]) -> bool:
        """Whether it can change what is reached."""
        return self.always or not self.changed.isdisjoint(found)


def _learns(node: ast.AST) -> bool:
    """Whether a class learns of its subclasses when they are made."""
    if not isinstance(node, ast.ClassDef):
        return False
    hooks = any(isinstance(s, ast.FunctionDef) and s.name == "__init_subclass__" for s in node.body)
    lists = any(isinstance(i, ast.Attribute) and i.attr == "__subclasses__" for i in ast.walk(node))
    return hooks or lists or any(k.arg == "metaclass" for k in node.keywords)


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
