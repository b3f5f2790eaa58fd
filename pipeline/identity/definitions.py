"""Which definitions a function can reach by name, through all modules of the packages that count, by their text alone.

A *definition* is what the top level of a module binds: a function, a class, a constant, one name of an import. Everything
that binds a name counts for it, in order. What cannot be resolved counts a whole module. A statement that binds nothing, or
that changes what another binds (`TABLE.update(…)`, a decorator that registers), counts where it can change what is reached.

Where a guess is needed it is that more is reached, never less.
"""

import ast
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

from kinetree.pipeline.identity.modules import EVERYTHING, IMPORTS, STATEMENTS, Definition, Modules
from kinetree.pipeline.identity.names import CALLED, HANDED, STORED, Names, Use, names_of
from kinetree.pipeline.identity.statements import Module, Statement


@dataclass(eq=False)
class Code(Modules):
    """The modules of some packages, and what a definition in them reaches."""

    harmless: tuple[str, ...] = ()
    """Packages that may not change a result: what a module hands to their functions changes nothing that is reached."""
    digests: dict[Definition, str] = field(default_factory=dict)
    """Of definitions, for whoever digests their syntax."""
    _edges: dict[Definition, frozenset[Definition]] = field(default_factory=dict)
    _effects: dict[frozenset[str], "list[_Effect]"] = field(default_factory=dict)

    def reached(self, module: str, name: str) -> dict[Definition, list[list[str]]]:
        """What the definition `name` of `module` reaches, itself included: the plain syntax of each, sorted.

        raises : ModuleNotFoundError where there is no text of `module`
        """
        self.module(module)
        reached: set[Definition] = set()
        counted: set[Statement] = set()
        modules = self.imported(module)
        waiting = set(self.resolve(module, name, ()))
        while waiting:
            self._reach(reached, waiting)
            waiting = set()
            for effect in self._effects_in(modules):
                if effect.statement not in counted and effect.counts(reached):
                    counted.add(effect.statement)
                    waiting |= effect.reached
        own = (one for one in reached if one[1] not in (EVERYTHING, STATEMENTS) and not self.is_import(one))
        syntax = {one: self._syntax(one) for one in own}
        for one in sorted(reached):
            if self.is_import(one):
                syntax.setdefault((one[0], IMPORTS), []).extend(self._syntax(one))
        return dict(sorted((syntax | self._orders(module, reached, counted)).items()))

    def _reach(self, reached: set[Definition], waiting: Iterable[Definition]) -> None:
        """Adds to `reached` what definitions reach by name."""
        rest = [one for one in waiting if one not in reached]
        while rest:
            one = rest.pop()
            if one not in reached:
                reached.add(one)
                rest.extend(self._next(one) - reached)

    def _next(self, one: Definition) -> frozenset[Definition]:
        """What a definition names."""
        if one not in self._edges:
            module, name = one
            here = self.module(module)
            reached: set[Definition] = set()
            if name == EVERYTHING:
                reached |= {(module, bound) for bound in here.bindings if bound != EVERYTHING} | {(module, STATEMENTS)}
            reached |= {(starred, EVERYTHING) for starred in here.starred if self.knows(starred)}
            for statement in self.parts(one):
                reached |= self.named(here, statement.uses)
            self._edges[one] = frozenset(reached)
        return self._edges[one]

    def _syntax(self, one: Definition) -> list[list[str]]:
        return [part.syntax for part in self.parts(one)]

    def _orders(self, module: str, reached: set[Definition], effects: set[Statement]) -> dict[Definition, list[list[str]]]:
        """Of every module in which it matters: the order of what is reached, with the statements that are no definitions."""
        effects = effects | {s for one in reached if one[1] == STATEMENTS for s in self.parts(one)}
        orders: dict[Definition, list[list[str]]] = {}
        for name in {one[0] for one in reached} | {s.module.name for s in effects}:
            here = self.module(name)
            counted = [s for s in here.statements if s in effects or any((name, n) in reached for n in s.names)]
            lines = [s for s in counted if s.kind != "import"]
            is_twice = any(len(here.bindings[n]) > 1 for s in lines for n in s.names)
            if is_twice or any(s in effects for s in counted):
                orders[name, STATEMENTS] = [s.syntax if s.kind == "effect" else [*s.names] for s in lines]
        if len({s.module.name for s in effects}) > 1:
            orders["", STATEMENTS] = [[m] for m in self.import_order(module) if any(s.module.name == m for s in effects)]
        return orders

    def _effects_in(self, modules: frozenset[str]) -> "list[_Effect]":
        """The statements of modules that can change what others define."""
        if modules not in self._effects:
            effects = [e for m in sorted(modules) for s in self.module(m).statements if (e := self._effect(s)) is not None]
            self._effects[modules] = effects
        return self._effects[modules]

    def _effect(self, statement: Statement) -> "_Effect | None":
        """What a statement can change when its module is imported; None where that is nothing but what it binds."""
        if statement.kind == "import" or self._is_harmless(statement):
            return None
        here, names = statement.module, statement.at_import
        own = {(here.name, name) for name in statement.names}
        changed = self._changed(here, names, handed=statement.kind == "effect") | self._subclassed(statement)
        named = self.named(here, names)
        below: set[Definition] = set()
        called = {one for call in names.uses if call.treated == CALLED for one in self.meant(here, call, names)}
        self._reach(below, called if statement.kind != "effect" else named)
        parts = [part for one in below for part in self.parts(one)]
        changed |= self._handed(here, names, always=any(part.uses.stores_locally for part in parts))
        for part in parts:
            bound = {(part.module.name, name) for name in part.names} if part.kind == "value" else set()
            changed |= self._changed(part.module, part.uses) - bound
        always = False
        if statement.kind == "effect":
            defined = {one for one in named if not self.is_import(one)}
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
        contents: set[Definition] = set()
        waiting = [*changed]
        while waiting:
            one = waiting.pop()
            if one not in contents:
                contents.add(one)
                for part in self.parts(one):
                    waiting += self._changed(part.module, part.uses) if part.kind == "value" else ()
        return contents

    def _handed(self, here: Module, names: Names, *, always: bool) -> set[Definition]:
        """The definitions that are handed to functions which may change them: others' functions, or all functions."""
        handed: set[Definition] = set()
        for call in names.calls:
            is_ours = any(not self.is_import(one) for one in self.meant(here, call.called, names))
            for use in call.handed:
                definitions = [one for one in self.meant(here, use, names) if not self.is_import(one)]
                handed.update(
                    one for one in definitions if (is_ours and always) or (not is_ours and self._can_change(one, use))
                )
        return handed

    def _changed(self, here: Module, names: Names, *, handed: bool = True) -> set[Definition]:
        """The definitions that names are used to change in place, as far as one can see.

        handed : whether what is handed on, to whatever end, counts
        """
        changed: set[Definition] = set()
        for use in names.uses:
            if use.treated > HANDED or (handed and use.treated == HANDED):
                for one in self.meant(here, use, names):
                    if self._can_change(one, use):
                        changed.add(one)
        return changed

    def _can_change(self, one: Definition, use: Use) -> bool:
        parts = self.parts(one)
        if self.is_import(one):
            return False
        is_state = any(p.is_registry or (p.kind == "value" and not p.is_fixed) for p in parts)
        if use.treated == STORED:
            return True
        if use.treated == CALLED:
            is_method = bool(use.attributes) and use.attributes[-1] != one[1]
            return is_method and (is_state or any(p.kind == "function" for p in parts))
        return use.treated == HANDED and is_state

    def _is_outward(self, here: Module, names: Names) -> bool:
        """Whether names are used to change what is no code of ours, such as a library's settings."""
        uses = [[*self.meant(here, use, names)] for use in names.outward]
        return any(meant and all(self.is_import(one) for one in meant) for meant in uses)

    def _subclassed(self, statement: Statement) -> set[Definition]:
        """The classes that learn of their subclasses, of which the statement makes one."""
        node = statement.nodes[-1]
        if not isinstance(node, ast.ClassDef):
            return set()
        classes: set[Definition] = set()
        bases = names_of([*node.bases], statement.module.name, is_package=statement.module.is_package)
        for one in self.named(statement.module, bases):
            for part in self.parts(one):
                learns = part.kind == "class" and _learns(part.nodes[-1])
                classes |= {one} if learns else set()
                classes |= self._subclassed(part)
        return classes


@dataclass(frozen=True, eq=False)
class _Effect:
    """A statement that changes what others define, and what counts where it does."""

    statement: Statement
    changed: frozenset[Definition]
    reached: frozenset[Definition]
    always: bool

    def counts(self, definitions: set[Definition]) -> bool:
        """Whether it can change what is reached."""
        return self.always or not self.changed.isdisjoint(definitions)


def _learns(node: ast.AST) -> bool:
    """Whether a class learns of its subclasses when they are made."""
    if not isinstance(node, ast.ClassDef):
        return False
    hooks = any(isinstance(s, ast.FunctionDef) and s.name == "__init_subclass__" for s in node.body)
    lists = any(isinstance(i, ast.Attribute) and i.attr == "__subclasses__" for i in ast.walk(node))
    return hooks or lists or any(k.arg == "metaclass" for k in node.keywords)
