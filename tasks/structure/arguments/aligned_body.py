"""The body as it was aligned, as the numerics of this shelf take it."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.structure.end_effectors import leaf_vertices
from kinetree.tasks.numerics.structure.given_correspondence import is_given, limited_confidence
from kinetree.tasks.numerics.structure.part_tree import MovingSurface


class AlignedBody(NamedTuple):
    """The body as it was aligned.

    surface    : the reference in motion
    trust      : (frame, vertex) 0 to 1
    confidence : the same; None where all are certain
    is_given   : whether the frames give the correspondence, see `given_correspondence`
    tips       : (leaf,) vertices at the ends of limbs
    """

    surface: MovingSurface
    trust: Floats
    confidence: Floats | None
    is_given: bool
    tips: Ints


def aligned_body(reference: Reference, alignment: Mapping[int, Alignment], leaves: Leaves) -> AlignedBody:
    """What the numerics take of an aligned sequence."""
    V, F, aligned = reference.vertices, reference.faces, list(alignment.values())
    x, trust = np.stack([a.vertices for a in aligned]), np.stack([a.confidence for a in aligned])
    confidence = limited_confidence(trust)  # residuals are not read where some are not certain
    return AlignedBody(
        MovingSurface(np.array(V), np.asarray(F, np.int64), x, surface_areas(V, F), take_spans(tuple(alignment))),
        trust,
        confidence,
        confidence is None and is_given(trust, np.stack([a.residual for a in aligned])),
        tips_of(reference, leaves),
    )


def tips_of(reference: Reference, leaves: Leaves) -> Ints:
    """(leaf,) vertices of the reference at the ends of limbs."""
    at = leaves.frames.index(reference.frame)
    return leaf_vertices(reference.vertices, leaves.positions[:, at], leaves.rows, at, leaves.kept)
