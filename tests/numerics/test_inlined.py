"""A function that compiled ones take into themselves."""

import numpy as np
import pytest

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.inlined import inlined


@inlined
def _raised(to, at, by):
    to[at] += by


@compiled
def _counted(values):
    out = np.zeros(3)
    for value in values:
        if value < 0:
            _raised(out, 0, -value)
        else:
            _raised(out, 1, value)
    return out


def test_it_changes_the_arrays_of_the_function_around_it_wherever_it_is_called():
    np.testing.assert_array_equal(_counted(np.array([-1.0, 2.0, -3.0, 4.5])), [4.0, 6.5, 0.0])


def test_division_by_nought_is_no_error_in_it():
    @inlined
    def share(a, b):
        return a / b

    assert np.isinf(share(1.0, 0.0))


@pytest.mark.parametrize("by", [0.5, -2.0])
def test_called_from_python_it_does_the_same(by):
    out = np.zeros(2)
    _raised(out, 1, by)
    np.testing.assert_array_equal(out, [0.0, by])
