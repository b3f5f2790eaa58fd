"""Whether an alignment is certain: a confidence of 1 everywhere, and where the frames themselves give every vertex."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


def limited_confidence(confidence: Floats) -> Floats | None:
    """The confidence of vertices where any is below 1; None where all are certain, so that nothing need be weighted.

    confidence : (frame, vertex) 0 to 1
    """
    return None if (confidence == 1.0).all() else np.asarray(confidence, np.float64)


def is_given(confidence: Floats, residual: Floats) -> bool:
    """Whether the frames give the correspondence, as with fixed connectivity: all certain, and none off its surface.

    confidence, residual : (frame, vertex) 0 to 1 · distance to the frame's surface, mesh unit
    """
    return bool((confidence == 1.0).all() and (residual == 0.0).all())
