"""What every schema is made of: `Artifact` (what is stored), `Params` (what may be set) and `Array` (a typed array field).

    class Mesh(Artifact):
        vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
        \"\"\"Position of every vertex.\"\"\"

An array field declares dtype, dimensions and unit beside its type and one sentence below it. A value is checked once, here,
when an artifact is made; arrays leave read-only. `length` as a unit is the unit of the user's own coordinates.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Self, cast, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, PrivateAttr, TypeAdapter, model_validator
from pydantic_core import core_schema

from kinetree.errors import ArtifactError
from kinetree.schemas.dims import Dim

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Bools = NDArray[np.bool_]
Index = tuple[int, ...]
Loader = Callable[[], NDArray[Any]]


@dataclass(frozen=True, init=False)
class Array:
    """Declares an array field: dtype, dimensions (with fixed sizes where they have them) and unit.

    dtype  : numpy name of the stored dtype; other values are cast where that is safe ("same_kind"), refused where not
    dims   : the dimensions, coarse to fine; equal names have equal sizes throughout one artifact
    unit   : of the values: "1", "length", "length²", "length³", "°" or "radian"
    finite : whether NaN and infinity are refused
    raises : ArtifactError, when a value breaks the declaration
    """

    dtype: str
    dims: tuple[Dim, ...]
    unit: str
    finite: bool

    def __init__(self, dtype: str, *dims: Dim, unit: str = "1", finite: bool = True) -> None:
        self.__dict__.update(dtype=dtype, dims=dims, unit=unit, finite=finite)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        """Pydantic's hook: the value is checked by `check`, whatever the annotated type."""
        return core_schema.with_info_plain_validator_function(lambda value, info: self.check(value, info.field_name))

    def check(self, value: Any, name: str | None = None) -> NDArray[Any]:
        """Returns `value` as a read-only contiguous array of this dtype, or says what is wrong with it."""
        try:
            untyped = np.asarray(value)
        except ValueError as error:
            raise ArtifactError(f"{name}: expected an array of dimensions {self.layout}, got {error}") from None
        if untyped.dtype.kind not in "biuf":
            raise ArtifactError(f"{name}: expected numbers of dtype {self.dtype}, got dtype {untyped.dtype}")
        if not _castable(untyped, np.dtype(self.dtype)):
            raise ArtifactError(f"{name}: expected dtype {self.dtype}, got {untyped.dtype}, which does not fit into it")
        array = np.ascontiguousarray(untyped, dtype=self.dtype).reshape(untyped.shape)
        if array.ndim != len(self.dims):
            raise ArtifactError(f"{name}: expected dimensions {self.layout}, got shape {array.shape}")
        for dim, size in zip(self.dims, map(int, array.shape), strict=True):
            if dim.size is not None and size != dim.size:
                raise ArtifactError(f"{name}: {dim.name} must be {dim.size} long, got shape {array.shape}")
        if self.finite and array.dtype.kind == "f" and not np.isfinite(array).all():
            bad = np.argwhere(~np.isfinite(array))
            raise ArtifactError(f"{name}: {len(bad)} values are not finite, the first at {tuple(bad[0].tolist())}")
        view = array.view()
        view.flags.writeable = False
        return view

    @property
    def layout(self) -> str:
        """The dimensions as text, e.g. (vertex, xyz=3)."""
        return "(" + ", ".join(d.name if d.size is None else f"{d.name}={d.size}" for d in self.dims) + ")"


@dataclass(frozen=True)
class Location:
    """Marks a field that says where bytes lie, not what they are: it is no part of the artifact's digest."""


@dataclass(frozen=True)
class PathLike:
    """Marks a parameter that is a path: relative to the configuration file that names it."""


class Artifact(BaseModel):
    """A stored value: frozen, its arrays declared and read-only, every other field plain JSON.

    An artifact whose members other tasks fan out over (the intervals of a sequence, the cones of an interval) names in
    `opens` the spaces it opens and lists their members in `members`; one that orders a traversal answers `previous` for
    members of the dimension `orders`, or, where that is empty, of the last dimension of the task that goes along it. One
    that selects some members of the dimension `selects` lists them in `selected`.
    What people see of it and take away stands elsewhere, in functions registered for its class.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")
    version: ClassVar[int] = 1
    opens: ClassVar[tuple[str, ...]] = ()
    orders: ClassVar[str] = ""
    selects: ClassVar[str] = ""
    _lazy: dict[str, Loader] = PrivateAttr(default_factory=dict)

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The members of the last dimension of `space` (one of `opens`) below `index`."""
        raise ArtifactError(f"{type(self).__name__} opens no index {space!r}")

    def previous(self, member: int) -> int | None:
        """The member before this one in the traversal this artifact orders; None where the traversal starts."""
        raise ArtifactError(f"{type(self).__name__} orders no traversal")

    def selected(self) -> Sequence[int]:
        """The members of the dimension `selects` that a task among them gathers."""
        raise ArtifactError(f"{type(self).__name__} selects no members")

    @classmethod
    def array_fields(cls) -> dict[str, Array]:
        """The declared arrays by field name."""
        return _array_fields(cls)

    @classmethod
    def location_fields(cls) -> frozenset[str]:
        """The fields that are no part of the digest."""
        return frozenset(n for n, f in cls.model_fields.items() if any(isinstance(m, Location) for m in f.metadata))

    @classmethod
    def lazily(cls, values: Mapping[str, Any], loaders: Mapping[str, Loader]) -> Self:
        """An artifact whose arrays are read when first asked for; `values` are the JSON fields as they were stored."""
        plain = {name: _adapter(cls, name).validate_python(v) for name, v in values.items()}
        artifact = cast("Self", cls.model_construct(**plain))
        artifact._lazy.update(loaders)
        return artifact

    def plain(self) -> dict[str, Any]:
        """The fields that are not arrays, as JSON values."""
        return self.model_dump(mode="json", exclude=set(self.array_fields()))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays by field name, read now where they were not yet."""
        return {name: getattr(self, name) for name in self.array_fields()}

    @model_validator(mode="after")
    def _equal_names_have_equal_sizes(self) -> Self:
        sizes: dict[str, tuple[int, str]] = {}
        for name, spec in self.array_fields().items():
            for dim, size in zip(spec.dims, getattr(self, name).shape, strict=True):
                known, where = sizes.setdefault(dim.name, (size, name))
                if known != size:
                    raise ArtifactError(f"{type(self).__name__}: {dim.name} is {known} long in {where} but {size} in {name}")
        return self

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Reads an array that was not read yet."""
            if name in type(self).model_fields and name in self._lazy:
                array = self.array_fields()[name].check(self._lazy[name](), name)
                self.__dict__[name] = array
                return array
            return super().__getattr__(name)

    def __eq__(self, other: object) -> bool:
        """Equal class, equal fields, equal arrays element by element."""
        if type(self) is not type(other) or not isinstance(other, Artifact) or self.plain() != other.plain():
            return False
        mine, theirs = self.arrays(), other.arrays()
        return all(np.array_equal(mine[n], theirs[n], equal_nan=mine[n].dtype.kind == "f") for n in mine)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """The JSON fields, and each array's shape, dtype and unit instead of its numbers."""
        rows = [f"{name}={value!r}" for name, value in self.plain().items()]
        for name, spec in self.array_fields().items():
            shape = self.__dict__[name].shape if name in self.__dict__ else "not read yet"
            rows.append(f"{name}: {spec.layout} {spec.dtype} {spec.unit} {shape}")
        return f"{type(self).__name__}({', '.join(rows)})"


class Params(BaseModel):
    """The configuration one task may see: frozen, no unknown keys, every field with a default and one sentence."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @classmethod
    def path_fields(cls) -> frozenset[tuple[str, ...]]:
        """The parameters that are paths, each as the keys that lead to it."""
        fields = cls.model_fields.items()
        paths: set[tuple[str, ...]] = {(n,) for n, f in fields if any(isinstance(m, PathLike) for m in f.metadata)}
        for name, field in cls.model_fields.items():
            for inner in (field.annotation, *get_args(field.annotation)):
                if isinstance(inner, type) and issubclass(inner, Params):
                    paths |= {(name, *rest) for rest in inner.path_fields()}
        return frozenset(paths)


def _castable(array: NDArray[Any], dtype: np.dtype[Any]) -> bool:
    if np.can_cast(array.dtype, dtype, "safe"):
        return True
    if array.dtype.kind in "iu" and dtype.kind in "iu":
        limits = np.iinfo(dtype)
        return array.size == 0 or (int(array.min()) >= limits.min and int(array.max()) <= limits.max)
    return array.dtype.kind == dtype.kind == "f"


@cache
def _array_fields(cls: type[Artifact]) -> dict[str, Array]:
    specs = {n: next((m for m in f.metadata if isinstance(m, Array)), None) for n, f in cls.model_fields.items()}
    return {name: spec for name, spec in specs.items() if spec is not None}


@cache
def _adapter(cls: type[Artifact], name: str) -> TypeAdapter[Any]:
    annotation: Any = cls.model_fields[name].annotation
    return TypeAdapter(annotation)
