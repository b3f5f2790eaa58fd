"""Names of joints for formats that allow only identifiers."""

import re
from collections.abc import Sequence

NOT_ALLOWED = re.compile(r"[^A-Za-z0-9_]")


def identifiers(names: Sequence[str]) -> list[str]:
    """The names as unique identifiers of ASCII letters, digits and underscores that do not begin with a digit.

    Every other character becomes an underscore; names that become equal are numbered.
    """
    unique: list[str] = []
    for name in names:
        plain = NOT_ALLOWED.sub("_", name)
        plain = plain if plain and not plain[0].isdigit() else f"_{plain}"
        numbered, number = plain, 2
        while numbered in unique:
            numbered, number = f"{plain}_{number}", number + 1
        unique.append(numbered)
    return unique
