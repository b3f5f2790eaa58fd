"""Distance of an alignment to each frame, its stretch, and which frames it explains (ours)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.edge_rings import edge_rings
from kinetree.tasks.numerics.registration.recovery import failures


class FrameConfidenceSettings(NamedTuple):
    """From which values on a frame is an outlier, besides those that stand out (`recovery.failures`)."""

    residual: float = 3.0
    """Residual in medians of the sequence. Chosen on: not recorded."""
    uncovered: float = 0.04
    """Share of a frame uncovered, even if all frames leave as much. Chosen on: not recorded."""


def residuals(x: Floats, V: Floats, F: npt.NDArray[np.integer]) -> Floats:
    """Distance of every vertex of the aligned body to the frame's surface, point to triangle.

    x       : (vertex, xyz) the body in this frame, mesh unit
    V, F    : (source, xyz) · (face, corner) the frame
    returns : (vertex,) mesh unit
    """
    return projected(x, V, F).distance


def stretches(rest: Floats, x: Floats, F: Ints) -> Floats:
    """Mean length of the edges around each vertex against their length at rest.

    rest, x : (vertex, xyz) the reference · the body in this frame, mesh unit
    F       : (face, corner) of both
    returns : (vertex,) without unit, 1 where nothing is stretched; 1 for a vertex without edges or with edges of no length
    """
    start, ring, _ = edge_rings(np.ascontiguousarray(F, np.int64), len(rest))
    return _stretches(rest, x, start, ring)


def inliers(
    uncovered: Floats, residual: Floats, settings: FrameConfidenceSettings | None = None, usual: Flags | None = None
) -> Flags:
    """Frames that the alignment explains: no more uncovered than the others, and no farther away (ours).

    uncovered : (frame,) share of each frame that the body does not explain
    residual  : (frame,) median distance of the body to each frame's surface, any unit
    usual     : (frame,) the frames with which all are compared; None takes all
    returns   : (frame,) False for frames that stand out
    """
    settings = settings or FrameConfidenceSettings()
    near = residual <= settings.residual * np.median(residual if usual is None else residual[usual])
    return ~failures(uncovered, usual=usual) & near & (uncovered <= settings.uncovered)


@compiled
def _stretches(rest: Floats, x: Floats, start: Ints, ring: Ints) -> Floats:
    """Stretch of every vertex, from the neighbours of each as `rings` gives them."""
    out = np.ones(len(rest))
    for v in range(len(rest)):
        before = after = 0.0
        for e in range(start[v], start[v + 1]):
            u = ring[e]
            before += np.sqrt((rest[v, 0] - rest[u, 0]) ** 2 + (rest[v, 1] - rest[u, 1]) ** 2 + (rest[v, 2] - rest[u, 2]) ** 2)
            after += np.sqrt((x[v, 0] - x[u, 0]) ** 2 + (x[v, 1] - x[u, 1]) ** 2 + (x[v, 2] - x[u, 2]) ** 2)
        if before > 0.0:
            out[v] = after / before
    return out
