"""What an alignment knows about itself: how far it is from each frame, how much it stretches, which frames to trust."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.registration.recovery import failures
from kinetree.tasks.numerics.registration.tracking import LOST

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]

_FAR = 3.0  # medians of the sequence: a frame whose residual exceeds this is not trusted


def residuals(x: Floats, V: Floats, F: npt.NDArray[np.integer]) -> Floats:
    """Distance of every vertex of the aligned body to the frame's surface, point to triangle.

    x       : (vertex, xyz) the body in this frame, mesh unit
    V, F    : (source, xyz) · (face, corner) the frame
    returns : (vertex,) mesh unit
    """
    return projected(x, V, F).distance


def stretches(rest: Floats, x: Floats, F: Ints) -> Floats:
    """Mean length of the edges around each vertex against their length at rest.

    rest, x : (vertex, xyz) the reference · the body in this frame
    F       : (face, corner) of both
    returns : (vertex,) 1 where nothing is stretched; 1 for a vertex without edges or with edges of no length
    """
    start, ring = rings(F, len(rest))
    return _stretches(rest, x, start, ring)


def trusted(uncovered: Floats, residual: Floats) -> Flags:
    """Frames to believe: no more uncovered than the others, and no further away.

    uncovered : (frame,) share of each frame that the body does not explain
    residual  : (frame,) mean residual, any unit
    returns   : (frame,) False for frames that stand out
    """
    return ~failures(uncovered) & (residual <= _FAR * np.median(residual)) & (uncovered <= 10 * LOST)


@compiled
def _stretches(rest: Floats, x: Floats, start: Ints, ring: Ints) -> Floats:
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
