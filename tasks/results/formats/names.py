"""Names of joints for formats that allow only identifiers, and for people."""

import re
from collections.abc import Sequence

from kinetree.schemas.structure.joint_names import JointNames

SIDES = {"_l": "left", "_r": "right"}
IDENTIFIER_FORMATS = ("bvh", "trc", "c3d", "usd", "rignet")
"""Formats whose joints are named by `identifiers`."""
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


def readable_names(joint_names: JointNames) -> tuple[str, ...]:
    """(joint,) what people call each joint, such as left knee; its name in files where nothing was recognised."""
    return tuple(in_words(of) if of else name for of, name in zip(joint_names.anatomy, joint_names.names, strict=True))


def station_and_side(anatomy: str) -> tuple[str, str]:
    """Words for a place of the body and its side, such as hind knee and left for hind_knee_l; the side may be empty."""
    side = SIDES.get(anatomy[-2:], "")
    return (anatomy[:-2] if side else anatomy).replace("_", " "), side


def in_words(anatomy: str) -> str:
    """What people call a place of the body, such as left knee for knee_l."""
    return " ".join(reversed(station_and_side(anatomy))).strip()
