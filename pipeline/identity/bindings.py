"""Which names a statement binds, in the scope it stands in: read off the syntax tree, nothing is imported or run."""

import ast
import importlib.util
from collections.abc import Iterable, Iterator

Target = tuple[str, str | None]
"""What an import binds: a module, and the name in it where it is one name."""
_SCOPES = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)


def bound_by(node: ast.AST, *, walrus: bool = True) -> set[str]:
    """The names that a statement binds or deletes in the scope it stands in.

    walrus : whether to look for `:=` in expressions, which takes longer
    """
    names: set[str] = set()
    for inner in statements_in([node]):
        if isinstance(inner, ast.Import | ast.ImportFrom):
            names.update(alias.asname or alias.name.partition(".")[0] for alias in inner.names)
        elif isinstance(inner, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            names.add(inner.name)
        elif isinstance(inner, ast.ExceptHandler):
            names |= {inner.name} if inner.name else set()
        else:
            for target in _targets(inner):
                names |= bound_in(target)
    return names | {n.target.id for n in _in_scope(node) if isinstance(n, ast.NamedExpr)} if walrus else names


def statements_in(body: Iterable[ast.AST]) -> Iterator[ast.AST]:
    """The statements of one scope, however deep, with handlers and cases; bodies of functions and classes are left out."""
    for node in body:
        yield node
        if not isinstance(node, _SCOPES):
            for name in ("body", "handlers", "cases", "orelse", "finalbody"):
                below = getattr(node, name, None)
                if below and isinstance(below, list):
                    yield from statements_in(below)


def _targets(node: ast.AST) -> list[ast.AST]:
    """The expressions in which a statement may bind names."""
    if isinstance(node, ast.Assign | ast.Delete):
        return [*node.targets]
    if isinstance(node, ast.AnnAssign | ast.AugAssign | ast.For | ast.AsyncFor | ast.comprehension):
        return [node.target]
    if isinstance(node, ast.With | ast.AsyncWith):
        return [item.optional_vars for item in node.items if item.optional_vars is not None]
    if isinstance(node, ast.match_case):
        return [node.pattern]
    return [getattr(node, "name")] if type(node).__name__ == "TypeAlias" else []  # noqa: B009 - a node of later Pythons


def bound_in(target: ast.AST) -> set[str]:
    """The names that a target or a pattern binds."""
    if isinstance(target, ast.Name):
        return {target.id}
    if isinstance(target, ast.Attribute | ast.Subscript):
        return set()
    names: set[str] = set()
    for inner in ast.walk(target):
        if isinstance(inner, ast.Name) and not isinstance(inner.ctx, ast.Load):
            names.add(inner.id)
        elif isinstance(inner, ast.MatchAs | ast.MatchStar) and inner.name:
            names.add(inner.name)
        elif isinstance(inner, ast.MatchMapping) and inner.rest:
            names.add(inner.rest)
    return names


def imported_by(node: ast.AST, module: str, *, is_package: bool) -> Iterator[tuple[str, Target]]:
    """The names that one import statement binds, and what to; the name of a starred import is "*"."""
    if isinstance(node, ast.Import):
        for alias in node.names:
            yield (
                alias.asname or alias.name.partition(".")[0],
                (alias.name if alias.asname else alias.name.partition(".")[0], None),
            )
    elif isinstance(node, ast.ImportFrom):
        package = module if is_package else module.rpartition(".")[0]
        origin = (
            importlib.util.resolve_name("." * node.level + (node.module or ""), package) if node.level else node.module or ""
        )
        for alias in node.names:
            yield alias.asname or alias.name, (origin, alias.name)


def children(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes right below a node."""
    for name in node._fields:
        value = getattr(node, name, None)
        if isinstance(value, list):
            yield from (item for item in value if isinstance(item, ast.AST))
        elif isinstance(value, ast.AST):
            yield value


def _in_scope(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes of one scope: bodies of functions, lambdas and classes are left out."""
    waiting = [node]
    while waiting:
        here = waiting.pop()
        yield here
        if isinstance(here, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            decorators = [] if isinstance(here, ast.Lambda) else here.decorator_list
            waiting += [*decorators, *here.args.defaults, *(d for d in here.args.kw_defaults if d)]
        elif isinstance(here, ast.ClassDef):
            waiting += [*here.decorator_list, *here.bases, *here.keywords]
        else:
            waiting += children(here)
