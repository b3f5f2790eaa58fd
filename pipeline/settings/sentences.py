"""The sentence below each field of a model, read off its source when somebody asks.

Pydantic can take them along when a class is made (`use_attribute_docstrings`). For all schemas that is a quarter of what it
costs to import every task, in every process, and only people read them.
"""

import ast
import inspect
from functools import cache
from itertools import pairwise
from textwrap import dedent

from pydantic import BaseModel


@cache
def sentences(model: type[BaseModel]) -> dict[str, str]:
    """By field name, also of fields that a base declares; a field without a sentence, or without source, is not in it."""
    texts: dict[str, str] = {}
    for cls in reversed(model.__mro__):
        if issubclass(cls, BaseModel) and cls is not BaseModel:
            texts |= _below(cls)
    return {name: texts[name] for name in model.model_fields if name in texts}


def _below(cls: type[BaseModel]) -> dict[str, str]:
    try:
        tree = ast.parse(dedent(inspect.getsource(cls)))
    except (OSError, TypeError):
        return {}
    (statement,) = tree.body
    texts: dict[str, str] = {}
    for field, following in pairwise(statement.body if isinstance(statement, ast.ClassDef) else ()):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(following, ast.Expr):
            if isinstance(following.value, ast.Constant) and isinstance(following.value.value, str):
                texts[field.target.id] = inspect.cleandoc(following.value.value)
    return texts
