"""Units of length and the conversion between them."""

import pytest

from kinetree.errors import InputError
from kinetree.tasks.numerics.results.units import METRES, unit_factor


def test_units_are_converted_where_both_are_known():
    assert unit_factor("m", "mm", "t") == pytest.approx(1000.0)
    assert unit_factor("km", "m", "t") == pytest.approx(1000.0)
    assert unit_factor("cm", None, "t") == unit_factor(None, "cm", "t") == unit_factor("ell", "ell", "t") == 1.0


@pytest.mark.parametrize("unit", METRES)
def test_conversion_there_and_back_changes_nothing(unit):
    assert unit_factor(unit, "ft", "t") * unit_factor("ft", unit, "t") == pytest.approx(1.0)


def test_unit_that_is_not_known_is_refused():
    with pytest.raises(
        InputError, match="t is in ell and the sequence in mm, but 'ell' cannot be converted; known units: mm, cm"
    ):
        unit_factor("ell", "mm", "t")
    with pytest.raises(InputError, match="t is in mm and the sequence in ell, but 'ell' cannot be converted"):
        unit_factor("mm", "ell", "t")
