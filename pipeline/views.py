"""What people see of artifacts and take away: functions registered by artifact class, outside the schemas' modules.

    @remarks_of(Reference)
    def reference_remarks(reference: Reference) -> tuple[str, ...]:

No task reaches such a function through its signature, so a sentence can be changed and nothing runs again. The class of an
artifact is looked up first, then its bases. A product names the modules of its views once, with `provide`; they are imported
when somebody asks for a view.
"""

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from kinetree.errors import GraphError

if TYPE_CHECKING:  # the help of the command line does without arrays
    from kinetree.schemas.array import Artifact, Index

A = TypeVar("A", bound="Artifact")
V = TypeVar("V")
Words = tuple[str, ...]
Run = Mapping[str, Any]
"""What run.json has, with the graph and the configuration."""


@dataclass(frozen=True)
class _Register(Generic[V]):
    """The views of one kind by artifact class."""

    kind: str
    by_class: "dict[type[Artifact], V]" = field(default_factory=dict)

    def add(self, cls: "type[Artifact]", view: V) -> None:
        known = self.by_class.setdefault(cls, view)
        if known is not view and _place(known) != _place(view):
            raise GraphError(f"two views give the {self.kind} of {cls.__name__}: {_place(known)} and {_place(view)}")
        self.by_class[cls] = view

    def of(self, cls: "type[Artifact]") -> V | None:
        _import_provided()
        return next((self.by_class[c] for c in cls.__mro__ if c in self.by_class), None)


_REMARKS: _Register[Callable[[Any], Words]] = _Register("remarks")
_TEXT: "_Register[tuple[Callable[..., Words], tuple[type[Artifact], ...]]]" = _Register("text")
_SUMMARIES: _Register[Callable[[Any], Mapping[str, Any]]] = _Register("summary")
_FILES: "_Register[Callable[[Any, Index], Mapping[str, bytes]]]" = _Register("files")
_GROUPS: _Register[str] = _Register("group")
_PAGES: _Register[tuple[str, Callable[[Any, Run], bytes]]] = _Register("page")
_ROWS: "_Register[Callable[[Any], Sequence[Mapping[str, Any]]]]" = _Register("rows")
_PROVIDED: dict[str, bool] = {}
"""Modules of views, and whether they are imported."""


def provide(*modules: str) -> None:
    """Names modules that register views when they are imported, which happens when a view is asked for."""
    for module in modules:
        _PROVIDED.setdefault(module, False)


def remarks_of(cls: type[A]) -> Callable[[Callable[[A], Words]], Callable[[A], Words]]:
    """Registers what a person should know of a result, in plain sentences."""

    def register(view: Callable[[A], Words]) -> Callable[[A], Words]:
        _REMARKS.add(cls, view)
        return view

    return register


def text_of(cls: type[A], *beside: "type[Artifact]") -> Callable[[Callable[..., Words]], Callable[..., Words]]:
    """Registers the result itself as lines of text, where shapes and statistics do not show it.

    beside : classes of other results that the text speaks of; the view is given them too, None where there are none
    """

    def register(view: Callable[..., Words]) -> Callable[..., Words]:
        _TEXT.add(cls, (view, beside))
        return view

    return register


def summary_of(cls: type[A]) -> Callable[[Callable[[A], Mapping[str, Any]]], Callable[[A], Mapping[str, Any]]]:
    """Registers what run.json says of a result that stands for the whole sequence, as JSON values."""

    def register(view: Callable[[A], Mapping[str, Any]]) -> Callable[[A], Mapping[str, Any]]:
        _SUMMARIES.add(cls, view)
        return view

    return register


def files_of(
    cls: type[A],
) -> "Callable[[Callable[[A, Index], Mapping[str, bytes]]], Callable[[A, Index], Mapping[str, bytes]]]":
    """Registers what a run leaves of an artifact in the output folder, given its index: bytes by name."""

    def register(view: "Callable[[A, Index], Mapping[str, bytes]]") -> "Callable[[A, Index], Mapping[str, bytes]]":
        _FILES.add(cls, view)
        return view

    return register


def page_of(cls: type[A], name: str) -> Callable[[Callable[[A, Run], bytes]], Callable[[A, Run], bytes]]:
    """Registers a file of that name which also tells of the run that left it."""

    def register(view: Callable[[A, Run], bytes]) -> Callable[[A, Run], bytes]:
        _PAGES.add(cls, (name, view))
        return view

    return register


def rows_of(
    cls: type[A],
) -> "Callable[[Callable[[A], Sequence[Mapping[str, Any]]]], Callable[[A], Sequence[Mapping[str, Any]]]]":
    """Registers the result as the rows of a table, with the same columns in each."""

    def register(view: "Callable[[A], Sequence[Mapping[str, Any]]]") -> "Callable[[A], Sequence[Mapping[str, Any]]]":
        _ROWS.add(cls, view)
        return view

    return register


def leave_group(cls: "type[Artifact]", name: str) -> None:
    """Registers that a run leaves the artifact in the output folder as the zarr group it is, under that name."""
    _GROUPS.add(cls, name)


def remarks(artifact: "Artifact") -> Words:
    """What a person should know of this result; most have nothing to say."""
    view = _REMARKS.of(type(artifact))
    return view(artifact) if view else ()


def text(artifact: "Artifact", others: "Callable[[type[Artifact]], Artifact | None]" = lambda _: None) -> Words:
    """The result itself as lines of text; empty where nobody registered any.

    others : gives the result of another class, None where there is none
    """
    view = _TEXT.of(type(artifact))
    return view[0](artifact, *map(others, view[1])) if view else ()


def summary(artifact: "Artifact") -> Mapping[str, Any]:
    """What run.json says of this; empty where nobody registered anything."""
    view = _SUMMARIES.of(type(artifact))
    return view(artifact) if view else {}


def has_summary(cls: "type[Artifact]") -> bool:
    """Whether run.json says something of artifacts of this class."""
    return _SUMMARIES.of(cls) is not None


def rows(artifact: "Artifact") -> list[dict[str, Any]]:
    """The result as the rows of a table; empty where nobody registered any."""
    view = _ROWS.of(type(artifact))
    return [dict(row) for row in view(artifact)] if view else []


def files(artifact: "Artifact", index: "Index") -> Mapping[str, bytes]:
    """What a run leaves of this, at `index`, in the output folder: bytes by name; most leave nothing."""
    view = _FILES.of(type(artifact))
    return view(artifact, index) if view else {}


def leaves_files(cls: "type[Artifact]") -> bool:
    """Whether artifacts of this class may leave files."""
    return _FILES.of(cls) is not None


def group_name(cls: "type[Artifact]") -> str:
    """The name under which artifacts of this class are left as zarr groups; empty where they are not."""
    return _GROUPS.of(cls) or ""


def page_name(cls: "type[Artifact]") -> str:
    """The name of the file of this class that also tells of the run; empty where there is none."""
    page_view = _PAGES.of(cls)
    return page_view[0] if page_view else ""


def page(artifact: "Artifact", run: Run) -> bytes:
    """The file that also tells of the run; raises GraphError where the class has none."""
    page_view = _PAGES.of(type(artifact))
    if page_view is None:
        raise GraphError(f"{type(artifact).__name__} has no page that tells of a run")
    return page_view[1](artifact, run)


def _import_provided() -> None:
    for module, is_imported in list(_PROVIDED.items()):
        if not is_imported:
            importlib.import_module(module)
            _PROVIDED[module] = True


def _place(view: Any) -> str:
    """Where a view is defined; a module that is imported again replaces its own."""
    if isinstance(view, tuple):
        return _place(next(part for part in view if callable(part)))
    return f"{view.__module__}.{view.__qualname__}" if callable(view) else repr(view)
