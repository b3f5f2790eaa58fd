"""The joints as the markers of a motion-capture clip, which has one frame time (ours)."""

import math
from typing import NamedTuple

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.results.glb import ASSUMED_FPS
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.names import identifiers


class Markers(NamedTuple):
    """A clip of markers.

    names     : (marker,) identifiers
    rate      : frames a second
    positions : (row, marker, xyz) at even steps; NaN where the sequence has no frame
    """

    names: list[str]
    rate: float
    positions: Floats


def markers(skeleton: Skeleton) -> Markers:
    """Every joint as a marker. Steps are as long as the frame numbers allow; missing frames stay missing."""
    step = math.gcd(*np.diff(skeleton.frames).tolist()) if len(skeleton.frames) > 1 else 1
    row = (np.array(skeleton.frames) - skeleton.frames[0]) // step
    X = np.full((int(row[-1]) + 1, *skeleton.positions.shape[1:]), np.nan)
    X[row] = skeleton.positions
    return Markers(identifiers(skeleton.names), (skeleton.fps or ASSUMED_FPS) / step, X)
