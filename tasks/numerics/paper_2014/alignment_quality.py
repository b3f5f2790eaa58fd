"""How well a mesh lies on a frame, for the alignments that this shelf makes (ours)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.frame_confidence import stretches
from kinetree.tasks.numerics.registration.vertex_confidence import vertex_confidence


class AlignmentQuality(NamedTuple):
    """What is known of an alignment in one frame.

    residual   : (vertex,) distance to the frame's surface, mesh unit
    stretch    : (vertex,) mean length of the edges around, against their length at rest
    confidence : (vertex,) 0 to 1
    uncovered  : share of the frame's vertices that the mesh does not explain
    """

    residual: Floats
    stretch: Floats
    confidence: Floats
    uncovered: float


def alignment_quality(
    rest: Floats, x: Floats, F: Ints, frame_V: Floats, frame_F: Ints, size: float, *, tracked: bool
) -> AlignmentQuality:
    """Residual, stretch and confidence of every vertex; where vertices are tracked they are where the frame has them.

    The uncovered share does not lower confidence: the geodesic mapping leaves much uncovered in every frame.

    rest, x          : (vertex, xyz) the mesh at rest · in the frame, mesh unit
    F                : (face, corner) of the mesh
    frame_V, frame_F : (frame's vertex, xyz) mesh unit · (face, corner) the frame
    size             : root of the mesh's area, mesh unit
    tracked          : whether the sequence has fixed connectivity, so that x is exact
    """
    if tracked:
        one = np.ones(len(x))
        return AlignmentQuality(0.0 * one, stretches(rest, x, F), one, 0.0)
    target = Target.of(frame_V, frame_F, size)
    quality = vertex_confidence(rest, x, smoothed_normals(x, F), F, target, usual=1.0)
    return AlignmentQuality(quality.residual, quality.stretch, quality.confidence, quality.uncovered)
