"""Laws of a schema: what fits is taken as it is, what does not is refused in words, and nothing can be changed afterwards."""

import pickle
from typing import Annotated

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from pydantic import ValidationError

from kinetree.errors import ArtifactError
from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints, Location, Params, PathLike
from kinetree.schemas.dims import CORNER, FACE, VERTEX, XYZ

V = np.arange(12.0).reshape(4, 3)


class Patch(Artifact):
    """A piece of surface."""

    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """Positions."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Corners."""
    kept: Annotated[Bools, Array("bool", VERTEX)]
    """A flag each."""
    free: Annotated[Floats, Array("float64", VERTEX, finite=False)]
    """May be NaN."""
    name: str = ""
    """A word."""


def patch(**changes):
    values = {
        "vertices": V, "faces": np.array([[0, 1, 2]], dtype=np.int32), "kept": np.ones(4, dtype=bool),
        "free": np.array([0, np.nan, np.inf, -np.inf]),
    }  # fmt: skip
    return Patch(**{**values, **changes})


def refusal(**changes):
    with pytest.raises(ArtifactError) as refused:
        patch(**changes)
    return str(refused.value)


# ── what fits ───────────────────────────────────────────────────────────────────────────────────────────────────────


def test_what_fits_is_taken_without_copying():
    assert np.shares_memory(patch().vertices, V)


def test_arrays_leave_read_only():
    stored = patch()
    for array in stored.arrays().values():
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    assert V.flags.writeable  # the caller's own array stays the caller's


def test_fields_cannot_be_set_added_or_forgotten():
    created = patch()
    with pytest.raises(ValidationError, match="frozen"):
        created.vertices = V
    with pytest.raises(ValidationError, match="frozen"):
        created.name = "other"
    with pytest.raises(ValidationError, match="Extra inputs are not permitted"):
        patch(surplus=1)
    with pytest.raises(ValidationError, match="Field required"):
        Patch(vertices=V)


@given(hnp.arrays(st.sampled_from(["f2", "f4", "f8", ">f8", "i1", "i4", "u2", "i8"]), (3, 3), elements=st.integers(0, 100)))
def test_numbers_that_fit_are_stored_in_the_declared_dtype(array):
    stored = Array("float64", VERTEX, XYZ).check(array)
    assert stored.dtype == np.float64
    assert stored.flags.c_contiguous
    np.testing.assert_array_equal(stored, array.astype(float))


@given(hnp.arrays(np.float64, hnp.array_shapes(min_dims=2, max_dims=2, min_side=0, max_side=4)), st.booleans())
def test_layout_in_memory_is_made_one(array, turned):
    given_ = np.asfortranarray(array) if turned else array
    stored = Array("float64", VERTEX, FACE, finite=False).check(given_)
    assert stored.flags.c_contiguous
    np.testing.assert_array_equal(stored, array)


def test_nothing_dimensional_and_empty_arrays_keep_their_shape():
    assert Array("float64").check(3).shape == ()
    assert Array("float64").check(np.array(3.0)).shape == ()
    assert Array("float64", VERTEX, XYZ).check(np.zeros((0, 3))).shape == (0, 3)
    assert patch(vertices=np.zeros((0, 3)), kept=np.zeros(0, dtype=bool), free=np.zeros(0)).vertices.shape == (0, 3)


@given(st.integers(-(2**40), 2**40))
def test_whole_numbers_are_taken_exactly_or_not_at_all(number):
    spec = Array("int32", VERTEX)
    if -(2**31) <= number < 2**31:
        assert spec.check(np.array([number]))[0] == number
    else:
        with pytest.raises(ArtifactError, match="expected dtype int32, got int64, which does not fit into it"):
            spec.check(np.array([number]))


# ── what does not ───────────────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"vertices": V[0]}, "vertices: expected dimensions (vertex, xyz=3), got shape (3,)"),
        ({"vertices": V[:, :2]}, "vertices: xyz must be 3 long, got shape (4, 2)"),
        ({"vertices": 1.0}, "vertices: expected dimensions (vertex, xyz=3), got shape ()"),
        ({"vertices": np.where(V > 9, np.nan, V)}, "vertices: 2 values are not finite, the first at (3, 1)"),
        ({"vertices": V * 1j}, "vertices: expected numbers of dtype float64, got dtype complex128"),
        ({"vertices": [["a", "b", "c"]]}, "vertices: expected numbers of dtype float64, got dtype <U1"),
        ({"vertices": V.astype(object)}, "vertices: expected numbers of dtype float64, got dtype object"),
        ({"vertices": None}, "vertices: expected numbers of dtype float64, got dtype object"),
        ({"vertices": V.astype("m8[s]")}, "vertices: expected numbers of dtype float64, got dtype timedelta64[s]"),
        ({"vertices": [[1.0], [1.0, 2.0]]}, "vertices: expected an array of dimensions (vertex, xyz=3), got "),
        ({"faces": [[0.0, 1.0, 2.0]]}, "faces: expected dtype int32, got float64, which does not fit into it"),
        ({"faces": np.array([[0, 1, 2**31]])}, "faces: expected dtype int32, got int64, which does not fit into it"),
        ({"faces": np.array([[0, 1, 2**63]], dtype=np.uint64)}, "faces: expected dtype int32, got uint64"),
        ({"kept": np.ones(4, dtype=np.uint8)}, "kept: expected dtype bool, got uint8, which does not fit into it"),
        ({"kept": np.ones(5, dtype=bool)}, "Patch: vertex is 4 long in vertices but 5 in kept"),
        ({"free": np.zeros(3)}, "Patch: vertex is 4 long in vertices but 3 in free"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else value[:40],
)  # fmt: skip
def test_what_does_not_fit_is_refused_with_field_found_and_expected(changes, told):
    assert refusal(**changes).startswith(told)


def test_what_may_be_anything_may_be_nan():
    np.testing.assert_array_equal(patch().free, [0, np.nan, np.inf, -np.inf])


# ── reading when asked for ──────────────────────────────────────────────────────────────────────────────────────────


def lazy(**loaders):
    arrays = patch(name="x").arrays()
    return Patch.lazily({"name": "x"}, {**{n: (lambda a=a: a) for n, a in arrays.items()}, **loaders})


def test_lazy_artifact_is_the_same_artifact():
    assert lazy() == patch(name="x")
    assert lazy().plain() == {"name": "x"}
    assert repr(lazy()) == (
        "Patch(name='x', vertices: (vertex, xyz=3) float64 length not read yet, faces: (face, corner=3) int32 1 not read yet,"
        " kept: (vertex) bool 1 not read yet, free: (vertex) float64 1 not read yet)"
    )


def test_lazy_array_is_read_when_asked_for_once_and_only_it():
    asked = []
    created = lazy(vertices=lambda: asked.append(1) or V, faces=lambda: pytest.fail("nobody asked"))
    assert asked == []
    assert created.vertices is created.vertices
    assert asked == [1]
    with pytest.raises(ValueError, match="read-only"):
        created.vertices[0] = 0


def test_lazy_array_that_breaks_its_declaration_is_refused_when_read():
    with pytest.raises(ArtifactError, match=r"^vertices: xyz must be 3 long"):
        assert lazy(vertices=lambda: V[:, :2]).vertices is None


def test_error_of_a_lazy_array_is_told_each_time_it_is_asked_for():
    def broken():
        raise OSError("gone")

    created = lazy(vertices=broken)
    for _ in range(2):
        with pytest.raises(OSError, match="gone"):
            created.arrays()


def test_what_is_no_field_is_no_attribute():
    with pytest.raises(AttributeError):
        _ = lazy().edges


# ── the rest ────────────────────────────────────────────────────────────────────────────────────────────────────────


def test_equality_looks_at_every_number():
    assert patch() == patch()
    assert patch() != patch(name="other")
    assert patch() != patch(vertices=V + 1e-12)
    assert patch() != patch(free=np.zeros(4))
    assert patch() != "patch"
    with pytest.raises(TypeError, match="unhashable"):
        hash(patch())


def test_artifacts_travel_between_processes():
    assert pickle.loads(pickle.dumps(patch())) == patch()


def test_artifact_that_opens_nothing_and_orders_nothing_says_so():
    with pytest.raises(ArtifactError, match=r"^Patch opens no index 'interval'$"):
        patch().members("interval", ())
    with pytest.raises(ArtifactError, match=r"^Patch orders no traversal$"):
        patch().previous(1)


def test_marks_are_found_by_field():
    class Where(Artifact):
        """Somewhere."""

        path: Annotated[str, Location()]
        """A file."""
        name: str
        """A word."""

    class WhereParams(Params):
        """Somewhere."""

        input: Annotated[str, PathLike()] = ""
        """A file."""
        count: int = 1
        """A number."""

    assert Where.location_fields() == {"path"}
    assert WhereParams.path_fields() == {("input",)}
    assert set(Patch.array_fields()) == {"vertices", "faces", "kept", "free"}


def test_params_are_finite_frozen_and_know_their_keys():
    class SizeParams(Params):
        """A size."""

        size: float = 1.0
        """How large."""

    for wrong in ({"size": np.inf}, {"size": np.nan}, {"sise": 1.0}, {"size": "large"}):
        with pytest.raises(ValidationError):
            SizeParams(**wrong)
    with pytest.raises(ValidationError, match="frozen"):
        SizeParams().size = 2.0
