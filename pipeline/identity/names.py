"""Which names of its module a statement uses, and how: read off the syntax tree, nothing is imported or run.

Python's scopes are followed: what a function binds (arguments, assignments, its own imports) hides the module's name of the
same spelling inside it and in what is nested in it; what a class body binds hides nothing; a comprehension hides its targets.
"""

import ast
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from kinetree.pipeline.identity.bindings import Target, bound_by, bound_in, children, imported_by, statements_in

READ, HANDED, CALLED, STORED = range(4)
"""How a use treats what it names: only reads it; hands it on, to whatever end; calls it, or a method of it; stores into it."""
DYNAMIC = frozenset({"globals", "exec", "eval", "__import__", "import_module", "__globals__", "_getframe", "currentframe"})
"""Names that reach definitions which no syntax tree shows."""
_UNCHANGING = """abs all any bool dict enumerate filter float frozenset getattr hasattr hash int isinstance issubclass iter len
list map max min next print range repr reversed round set sorted str sum super tuple type zip"""
READERS = frozenset(_UNCHANGING.split())
"""Built-in functions that leave their arguments as they are."""
Scope = dict[str, tuple[Target, ...]]
Function = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda


class Use(NamedTuple):
    """A name, the attributes that follow it, what a function's own import binds it to, and how it is treated."""

    name: str
    attributes: tuple[str, ...]
    targets: tuple[Target, ...]
    treated: int


class Call(NamedTuple):
    """A function that is called, and what is handed to it."""

    called: Use
    handed: tuple[Use, ...]


@dataclass
class Names:
    """What a statement uses of its module and of others."""

    uses: list[Use] = field(default_factory=list)
    calls: list[Call] = field(default_factory=list)
    strings: list[str] = field(default_factory=list)
    """Texts in it, which may name a module where `is_dynamic`."""
    is_dynamic: bool = False
    """Whether it may reach what it does not name."""
    outward: list[Use] = field(default_factory=list)
    """What it calls for no value, and what it stores into: where this is no code of ours, the world is changed."""
    bound_in_classes: set[str] = field(default_factory=set)
    """Names that class bodies in it bind, which are seen there alone."""
    stores_locally: bool = False
    """Whether it stores into something that it was handed or made, which may be anything that was handed to it."""


def names_of(nodes: Sequence[ast.AST], module: str, *, is_package: bool, walrus: bool = True) -> Names:
    """The names that nodes of a module use."""
    reader = _Reader(module, is_package, walrus=walrus)
    for node in nodes:
        reader.read(node)
    return reader.names


class _Reader:
    """Walks a tree with the scopes around the node it is at."""

    def __init__(self, module: str, is_package: bool, *, walrus: bool) -> None:
        self.names = Names()
        self._module, self._is_package, self._walrus = module, is_package, walrus
        self._scopes: list[Scope] = []

    def read(self, node: ast.AST, treated: int = HANDED) -> None:
        """Notes every use below a node; `treated` says what becomes of the node's value."""
        kind = type(node).__name__
        if kind in _COMPREHENSIONS:
            self._comprehension(node)
            return
        special = getattr(self, f"_read_{kind}", None)
        if special is not None:
            special(node, treated)
        else:
            below = READ if kind in _READING or (treated == READ and kind in _HOLDING) else HANDED
            for child in children(node):
                self.read(child, below)

    def _read_all(self, nodes: Sequence[ast.AST | None], treated: int = HANDED) -> None:
        for node in nodes:
            if node is not None:
                self.read(node, treated)

    def _use(self, node: ast.AST, treated: int) -> Use | None:
        """The use of the name that a chain of attributes begins with; None where the name is a local one."""
        attributes: list[str] = []
        while isinstance(node, ast.Attribute):
            attributes.append(node.attr)
            node = node.value
        if not isinstance(node, ast.Name):
            self.read(node, treated)
            return None
        chain = (node.id, *reversed(attributes))
        if DYNAMIC & set(chain) or chain[:2] == ("sys", "modules"):
            self.names.is_dynamic = True
        if chain[0] in ("locals", "vars") and not self._scopes:
            self.names.is_dynamic = True
        hiding = next((scope for scope in reversed(self._scopes) if chain[0] in scope), None)
        if hiding is not None and not hiding[chain[0]]:
            self.names.stores_locally |= treated == STORED or (treated == CALLED and len(chain) > 1)
            return None
        use = Use(chain[0], chain[1:], () if hiding is None else hiding[chain[0]], treated)
        self.names.uses.append(use)
        if treated == STORED:
            self.names.outward.append(use)
        return use

    def _read_Name(self, node: ast.Name, treated: int) -> None:
        self._use(node, treated if isinstance(node.ctx, ast.Load) else STORED)

    def _read_Attribute(self, node: ast.Attribute, treated: int) -> None:
        self._use(node, treated if isinstance(node.ctx, ast.Load) else STORED)

    def _read_Subscript(self, node: ast.Subscript, treated: int) -> None:
        self.read(node.value, treated if isinstance(node.ctx, ast.Load) else STORED)
        self.read(node.slice, READ)

    def _read_Starred(self, node: ast.Starred, _: int) -> None:
        self.read(node.value, READ)

    def _read_Constant(self, node: ast.Constant, _: int) -> None:
        if isinstance(node.value, str):
            self.names.strings.append(node.value)

    def _read_Expr(self, node: ast.Expr, _: int) -> None:
        if not isinstance(node.value, ast.Constant):
            before = len(self.names.uses)
            self.read(node.value)
            if isinstance(node.value, ast.Call):
                self.names.outward += [use for use in self.names.uses[before : before + 1] if use.treated == CALLED]

    def _read_Call(self, node: ast.Call, _: int) -> None:
        called = self._use(node.func, CALLED)
        arguments = [*node.args, *(k.value for k in node.keywords)]
        word = node.func.id if isinstance(node.func, ast.Name) else ""
        if word in ("cast", "TypeVar"):
            for argument in arguments:
                self._annotation(argument)
        before = len(self.names.uses)
        self._read_all(arguments[:1], STORED if word in ("setattr", "delattr") else READ if word in READERS else HANDED)
        self._read_all(arguments[1:], READ if word in READERS else HANDED)
        handed = tuple(use for use in self.names.uses[before:] if use.treated == HANDED)
        if called is not None and handed:
            self.names.calls.append(Call(called, handed))

    def _read_AnnAssign(self, node: ast.AnnAssign, _: int) -> None:
        self.read(node.target)
        self._annotation(node.annotation)
        self._read_all([node.value])

    def _read_FunctionDef(self, node: ast.FunctionDef | ast.AsyncFunctionDef, _: int) -> None:
        self._decorators(node.decorator_list)
        self._signature(node.args)
        if node.returns is not None:
            self._annotation(node.returns)
        self._within(node, node.body)

    def _read_AsyncFunctionDef(self, node: ast.AsyncFunctionDef, treated: int) -> None:
        self._read_FunctionDef(node, treated)

    def _read_Lambda(self, node: ast.Lambda, _: int) -> None:
        self._signature(node.args)
        self._within(node, [node.body])

    def _read_ClassDef(self, node: ast.ClassDef, _: int) -> None:
        self._decorators(node.decorator_list)
        self._read_all([*node.bases, *(k.value for k in node.keywords)], READ)
        for statement in node.body:
            self.names.bound_in_classes |= bound_by(statement, walrus=self._walrus)
        self._read_all(node.body)

    def _decorators(self, decorators: Sequence[ast.AST]) -> None:
        self._read_all(decorators, CALLED)

    def _signature(self, arguments: ast.arguments) -> None:
        self._read_all([*arguments.defaults, *arguments.kw_defaults])
        for argument in _arguments(arguments):
            if argument.annotation is not None:
                self._annotation(argument.annotation)

    def _within(self, function: Function, body: Sequence[ast.AST]) -> None:
        """The body of a function, in which what it binds hides what stands outside."""
        bound: set[str] = set()
        for statement in body:
            bound |= bound_by(statement, walrus=self._walrus)
        inside = [*statements_in(body)]
        declared = {name for inner in inside if isinstance(inner, ast.Global) for name in inner.names}
        scope: Scope = dict.fromkeys((bound - declared) | {a.arg for a in _arguments(function.args)}, ())
        for inner in inside:
            for name, target in imported_by(inner, self._module, is_package=self._is_package):
                scope[name] = (*scope.get(name, ()), target)
        self._scopes.append(scope)
        self._read_all(body)
        self._scopes.pop()

    def _comprehension(self, node: ast.AST) -> None:
        """A comprehension: its first iterable belongs outside, everything else sees its targets."""
        generators: list[ast.comprehension] = node.generators  # type: ignore[attr-defined]
        self.read(generators[0].iter, READ)
        self._scopes.append({name: () for g in generators for name in bound_in(g.target)})
        for number, generator in enumerate(generators):
            self._read_all([*([generator.iter] if number else []), *generator.ifs], READ)
        self._read_all([getattr(node, part, None) for part in ("elt", "key", "value")])
        self._scopes.pop()

    def _annotation(self, node: ast.AST) -> None:
        """An annotation: texts in it are names that stand further down, save in literals and in what is called."""
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            try:
                self.read(ast.parse(node.value.strip(), mode="eval").body, READ)
            except SyntaxError:
                return
        elif isinstance(node, ast.Call):
            self.read(node, READ)
        elif isinstance(node, ast.Subscript):
            self.read(node.value, READ)
            if not ast.unparse(node.value).endswith("Literal"):
                self._annotation(node.slice)
        elif isinstance(node, ast.Name | ast.Attribute):
            self.read(node, READ)
        else:
            for child in children(node):
                self._annotation(child)


_READING = frozenset(
    {"Compare", "BinOp", "UnaryOp", "JoinedStr", "FormattedValue", "ExceptHandler", "Raise", "Assert", "Slice"}
)
"""Expressions and statements that leave what they name as it is."""

_COMPREHENSIONS = frozenset({"ListComp", "SetComp", "DictComp", "GeneratorExp"})
_HOLDING = frozenset({"Tuple", "List", "Set", "Dict", "IfExp", "BoolOp", "keyword"})
"""Expressions with which the same becomes of what is in them as of themselves."""


def _arguments(a: ast.arguments) -> list[ast.arg]:
    return [x for x in (*a.posonlyargs, *a.args, *a.kwonlyargs, a.vararg, a.kwarg) if x is not None]
