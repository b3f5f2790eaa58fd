"""How the signature of a task reads: which artifacts an argument asks for, and how many of them.

    X                            the artifact of the same index (over interval/frame, who asks for a Mesh gets its frame's)
    tuple[X, ...]                every X below this index, in order
    Mapping[int, X]              the same by member number, for a task to which the numbers matter

and, in a task that goes along a traversal:

    X | None                     X at this index with the previous member in place of this one; None where the traversal starts
    Previous[tuple[X, ...]]      every X below that index, in order; empty where the traversal starts
    Previous[Mapping[int, X]]    the same by member number
"""

import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeVar, Union

from kinetree.errors import GraphError
from kinetree.schemas.array import Artifact

T = TypeVar("T")
Form = Literal["one", "tuple", "mapping"]


class AtPrevious:
    """Marks an argument that is read at the previous member of the task's traversal."""


Previous = Annotated[T, AtPrevious]
"""Previous[tuple[X, ...]]: every X below the index that has the previous member; empty where the traversal starts."""


@dataclass(frozen=True)
class Argument:
    """One edge: the argument's name, the artifact class it reads and how many of them."""

    name: str
    artifact: type[Artifact]
    form: Form
    previous: bool = False
    """Whether it is read at the previous member of the traversal, and lacking where that starts."""


def argument_of(name: str, hint: Any, returns: type[Artifact], place: str) -> Argument:
    """The edge that an argument's annotation stands for; raises GraphError where it stands for none."""
    if isinstance(hint, type) and issubclass(hint, Artifact):
        return Argument(name, hint, "one")
    outer, inner = typing.get_origin(hint), typing.get_args(hint)
    if outer in (Union, types.UnionType) and len(inner) == 2 and type(None) in inner:
        (other,) = (t for t in inner if t is not type(None))
        if _is_artifact(other):
            return Argument(name, other, "one", previous=True)
    is_previous = outer is Annotated and inner[1:] == (AtPrevious,)
    gathered = _gathered(inner[0] if is_previous else hint)
    if gathered is None:
        raise GraphError(
            f"{place}: argument {name} must be an Artifact, tuple[Artifact, ...] or Mapping[int, Artifact], or, at the previous"
            f" member of a traversal, {returns.__name__} | None, Previous[tuple[Artifact, ...]] or"
            f" Previous[Mapping[int, Artifact]]; got {hint!r}"
        )
    artifact, form = gathered
    return Argument(name, artifact, form, previous=is_previous)


def _gathered(hint: Any) -> tuple[type[Artifact], Form] | None:
    """The artifact class and the form of an argument that gathers many; None for any other."""
    outer, inner = typing.get_origin(hint), typing.get_args(hint)
    if outer is tuple and len(inner) == 2 and inner[1] is Ellipsis and _is_artifact(inner[0]):
        return inner[0], "tuple"
    if outer is Mapping and inner[0] is int and _is_artifact(inner[1]):
        return inner[1], "mapping"
    return None


def artifact_of(hint: Any, place: str, *, is_origin: bool) -> type[Artifact]:
    """The class that a task writes, by the annotation of what it returns; raises GraphError where it is no artifact."""
    if is_origin and typing.get_origin(hint) is Mapping:
        hint = typing.get_args(hint)[1]
    if not _is_artifact(hint):
        raise GraphError(f"{place}: the return type must be an Artifact, got {hint!r}")
    return typing.cast("type[Artifact]", hint)


def _is_artifact(hint: Any) -> bool:
    return isinstance(hint, type) and issubclass(hint, Artifact)
