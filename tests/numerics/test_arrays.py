"""The types of arrays are named in one place."""

import re
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from kinetree.tasks.numerics import arrays

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("alias", "element"),
    [
        (arrays.Floats, np.float64),
        (arrays.Ints, np.int64),
        (arrays.Flags, np.bool_),
        (arrays.Indices, np.uint32),
        (arrays.Lengths, np.float32),
        (arrays.Labels, np.int32),
        (arrays.Faces, np.int32),
    ],
)
def test_an_array_type_says_what_one_element_is(alias: Any, element: type) -> None:
    held = get_args(alias)[-1]  # a dtype before numpy 2.5, then the element itself
    assert (get_args(held) or (held,)) == (element,)


@pytest.mark.parametrize("folder", ["tasks/numerics/geometry", "tasks/numerics/input", "tasks/numerics/topology"])
def test_no_other_module_names_them_again(folder: str) -> None:
    named = {name for name in vars(arrays) if name[0].isupper()}
    again = re.compile(rf"^({'|'.join(named)}) = ", re.MULTILINE)
    assert [str(p.relative_to(ROOT)) for p in (ROOT / folder).rglob("*.py") if again.search(p.read_text())] == []
