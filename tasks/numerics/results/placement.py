"""Rotations that bring a body upright, and the unit of a body of unknown unit (ours)."""

from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats

Axis = Literal["x", "y", "z", "-x", "-y", "-z"]
UP_ROTATIONS: Mapping[str, tuple[tuple[int, int, int], ...]] = {
    "y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)), "-y": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)), "-z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "x": ((0, 0, 1), (1, 0, 0), (0, 1, 0)), "-x": ((0, 0, 1), (-1, 0, 0), (0, -1, 0)),
}  # fmt: skip
"""Rotation that brings each axis to +y, by rows; z-up turns as between Blender and glTF: -y, its front, becomes +z."""


class SizeSettings(NamedTuple):
    """What is taken for the size of a body whose unit is not known."""

    usual: float = 1.0
    """Longest side of a body, metres; chosen between people and animals as large as a dog, not tuned."""
    units: tuple[float, ...] = (1.0, 0.01, 0.001)
    """Metres of the units that files are in: m, cm and mm. Of two units, the one that brings the size nearer to the usual one
    by ratio is taken: metres below 10 units, centimetres below 316."""


def upright_rotation(up: str, wanted: str = "y", front: Floats | None = None) -> Floats:
    """Rotation by right angles that brings one axis to another  (ours).

    up      : axis that points up: x, y, z, -x, -y or -z
    wanted  : axis that it is brought to: y or z
    front   : (xyz,) direction that the body faces, which comes as near as right angles allow to +z where y is up and to −y
              where z is; None: nothing is rotated about the vertical
    returns : (row, xyz) for columns of coordinates
    """
    to_y = np.array(UP_ROTATIONS[up], np.float64)
    if front is not None:
        x, _, z = to_y @ front
        quarters = int(np.rint(-np.arctan2(x, z) / (np.pi / 2)))
        c, s = round(np.cos(quarters * np.pi / 2)), round(np.sin(quarters * np.pi / 2))
        to_y = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]], np.float64) @ to_y
    return to_y if wanted == "y" else np.array(UP_ROTATIONS["z"], np.float64).T @ to_y


def guessed_metres(size: float, settings: SizeSettings | None = None) -> float:
    """Metres of one unit, guessed from the longest side of a body, which is one of metres, centimetres or millimetres  (ours).

    size    : longest side of the body's box in its own unit
    returns : metres of one unit; 1 for a body without size
    """
    s = settings or SizeSettings()
    if not size > 0.0:
        return 1.0
    return min(s.units, key=lambda metres: abs(np.log(size * metres / s.usual)))
