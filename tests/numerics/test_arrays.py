"""The types of arrays are named in one place."""

from typing import Any, get_args

import numpy as np
import pytest

from kinetree.tasks.numerics import arrays


@pytest.mark.parametrize(
    ("alias", "element"),
    [
        (arrays.Floats, np.float64),
        (arrays.Ints, np.int64),
        (arrays.Flags, np.bool_),
        (arrays.Indices, np.uint32),
        (arrays.Lengths, np.float32),
        (arrays.Labels, np.int32),
    ],
)
def test_an_array_type_says_what_one_element_is(alias: Any, element: type) -> None:
    assert get_args(get_args(alias)[1]) == (element,)
