"""Laws of the list of kernels: it fits the code, and types are read as they were written."""

import importlib
import inspect

import numba
import numpy as np
import pytest

from kinetree.tasks.numerics.input.synth.implicit import Cones
from kinetree.tasks.numerics.kernel_list import compile_all, lines, text_of, type_of

LEXICOGRAPHIC = "kinetree.tasks.numerics.geometry.orientation.lexicographic"


def listed(*values):
    return [numba.typeof(value) for value in values]


@pytest.mark.parametrize(
    "kind",
    [
        *listed(1.5, 3, True, np.uint64(3), (1, 2, 3), (np.zeros(2, np.uint32), 1.0)),
        *listed(np.zeros((2, 3)), np.zeros((2, 3), order="F"), np.zeros((4, 6))[::2, ::2], np.zeros(3, bool)),
        *listed(np.frombuffer(bytes(16))),
        *listed(np.zeros(2, np.dtype([("target", np.uint32), ("length", np.float32)]))),
        numba.types.BaseTuple.from_types([numba.float64[:, ::1]] * len(Cones._fields), Cones),
    ],
    ids=str,
)
def test_a_type_is_read_as_it_was_written(kind):
    assert type_of(text_of(kind)) == kind


def test_what_has_no_text_is_refused():
    with pytest.raises(TypeError, match="no text for"):
        text_of(numba.typeof("text"))


def test_every_line_names_a_kernel_and_as_many_types_as_it_takes():
    for name, types in lines():
        module, _, function = name.rpartition(".")
        kernel = getattr(importlib.import_module(module), function)
        assert len(inspect.signature(kernel.py_func).parameters) == len(types), name
        assert [text_of(type_of(text)) for text in types] == types


def test_the_list_names_no_kernel_twice_with_the_same_types():
    assert len({str(line) for line in lines()}) == len(lines()) > 50


def test_kernels_that_are_gone_or_take_other_types_are_passed_over():
    fits = (LEXICOGRAPHIC, ["int32[2C]", "int64"])
    gone = [(f"{LEXICOGRAPHIC}_", []), ("kinetree.tasks.numerics.gone.gone", []), (LEXICOGRAPHIC, ["int64"])]
    assert compile_all([*gone, fits, (LEXICOGRAPHIC, ["float999"])], lambda: True) == 1


def test_nothing_more_is_compiled_when_nobody_wants_it():
    wanted = iter([True, False, True])
    fits = (LEXICOGRAPHIC, ["int32[2C]", "int64"])
    assert compile_all([fits] * 3, lambda: next(wanted)) == 1
