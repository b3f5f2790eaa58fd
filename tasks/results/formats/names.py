"""Names of joints as strict formats take them."""

import re
from collections.abc import Sequence

TAKEN = re.compile(r"[^A-Za-z0-9_]")


def identifiers(names: Sequence[str]) -> list[str]:
    """The names in ASCII letters, digits and underscores, beginning with no digit, still unique.

    Any other character becomes an underscore; names that thereby become equal are numbered.
    """
    found: list[str] = []
    for name in names:
        plain = TAKEN.sub("_", name)
        plain = plain if plain and not plain[0].isdigit() else f"_{plain}"
        numbered, number = plain, 2
        while numbered in found:
            numbered, number = f"{plain}_{number}", number + 1
        found.append(numbered)
    return found
