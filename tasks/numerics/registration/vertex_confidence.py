"""How reliable each vertex of an aligned body is in one frame, from the alignment and the frame alone (ours)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.registration.correspondence import CorrespondenceSettings, Target
from kinetree.tasks.numerics.registration.frame_confidence import stretches


class VertexConfidenceSettings(NamedTuple):
    """At which value each factor of the confidence is a half."""

    residual: float = CorrespondenceSettings().covered
    """Distance to the frame's surface, share of √area: that at which a vertex no longer covers a sample."""
    stretch: float = float(np.log(2.0))
    """Logarithm of the stretch: edges twice or half as long as at rest. Chosen on: not recorded."""
    round_trip: float = 0.04
    """Distance at rest after mapping to the frame and back, share of √area. Chosen on: not recorded."""
    uncovered: float = 0.04
    """Share of a frame uncovered beyond the usual; lowers the confidence of all vertices. Chosen on: not recorded."""


class VertexConfidence(NamedTuple):
    """Confidence of every vertex in one frame and what it is made of.

    residual   : (vertex,) distance to the frame's surface, point to triangle, mesh unit
    stretch    : (vertex,) mean length of the edges around, against their length at rest
    round_trip : (vertex,) distance at rest between a vertex and its image after mapping to the frame and back, mesh unit
    confidence : (vertex,) 0 to 1
    uncovered  : share of the frame's vertices that the body does not explain, 0 to 1
    """

    residual: Floats
    stretch: Floats
    round_trip: Floats
    confidence: Floats
    uncovered: float


def vertex_confidence(
    rest: Floats,
    x: Floats,
    n: Floats,
    F: Ints,
    target: Target,
    usual: float = 0.0,
    settings: VertexConfidenceSettings | None = None,
) -> VertexConfidence:
    """Confidence of every vertex, h(residual) h(log stretch) h(round trip) h(uncovered), h(y) = 1 / (1 + (y / scale)²) (ours).

    rest, x : (vertex, xyz) the body at rest · in this frame, mesh unit
    n       : (vertex, xyz) its unit normals in this frame
    F       : (face, corner) of the body
    target  : the frame
    usual   : share that no frame covers, such as holes of the capture, 0 to 1
    returns : VertexConfidence
    """
    settings = settings or VertexConfidenceSettings()
    there = projected(x, target.V, target.F)
    back = projected(target.V, x, F)
    origin = np.einsum("pk,pkx->px", back.share, rest[F[back.face]])
    round_trip = np.linalg.norm(np.einsum("vk,vkx->vx", there.share, origin[target.F[there.face]]) - rest, axis=1)
    cosine = np.einsum("pk,pkx,px->p", back.share, n[F[back.face]], target.N)
    coverage = CorrespondenceSettings()
    covered = (back.distance < coverage.covered * target.size) & (cosine > coverage.cosine)
    uncovered = 1.0 - float(covered.mean())
    stretch = stretches(rest, x, F)
    confidence = (
        _half_at(there.distance, settings.residual * target.size)
        * _half_at(np.log(np.maximum(stretch, np.finfo(float).tiny)), settings.stretch)
        * _half_at(round_trip, settings.round_trip * target.size)
        * float(_half_at(np.array(max(uncovered - usual, 0.0)), settings.uncovered))
    )
    return VertexConfidence(there.distance, stretch, round_trip, confidence, uncovered)


def _half_at(y: Floats, scale: float) -> Floats:
    """1 / (1 + (y / scale)²): 1 at 0, a half at the scale."""
    return 1.0 / (1.0 + (y / scale) ** 2)
