"""Units of length, and how lengths are converted from one to another."""

from kinetree.errors import InputError

METRES = {"mm": 0.001, "cm": 0.01, "dm": 0.1, "m": 1.0, "km": 1000.0, "in": 0.0254, "ft": 0.3048}
"""Length of one of each unit in metres."""


def unit_factor(unit: str | None, wanted: str | None, name: str) -> float:
    """The number by which lengths in `unit` are multiplied to be in `wanted`.

    unit, wanted : names of units as in METRES; None for an unknown one
    name         : name of the file whose unit it is, for messages
    returns      : 1 where one of the two is unknown or both are the same
    raises       : InputError where both are known and differ, and one of them is not in METRES
    """
    if unit is None or wanted is None or unit == wanted:
        return 1.0
    for one in (unit, wanted):
        if one not in METRES:
            raise InputError(
                f"{name} is in {unit} and the sequence in {wanted}, but {one!r} cannot be converted; known units:"
                f" {', '.join(METRES)}"
            )
    return METRES[unit] / METRES[wanted]
