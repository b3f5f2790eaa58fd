"""How far each vertex of an aligned body is to be believed in one frame, from what the alignment can see of itself."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.registration.correspondence import ALIKE, COVERED, Target
from kinetree.tasks.numerics.registration.frame_confidence import stretches

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

RETURN = 0.04  # a way there and back that ends this far from where it began halves belief, share of the body's size
STRETCH = float(np.log(2.0))  # edges twice or half as long as at rest halve it
LEFT = 0.04  # this share of a frame uncovered, beyond what is usual, halves it everywhere


class VertexConfidence(NamedTuple):
    """What an aligned body knows about itself in one frame.

    residual  : (vertex,) distance to the frame's surface, point to triangle, mesh unit
    stretch   : (vertex,) mean length of the edges around, against their length at rest
    wander    : (vertex,) from each vertex to the frame and back to the body: how far from it at rest, mesh unit
    trust     : (vertex,) 0 to 1
    uncovered : share of the frame's vertices that the body does not explain
    """

    residual: Floats
    stretch: Floats
    wander: Floats
    trust: Floats
    uncovered: float


def vertex_confidence(rest: Floats, x: Floats, n: Floats, F: Ints, target: Target, usual: float = 0.0) -> VertexConfidence:
    """Trust of every vertex, h(residual) h(log stretch) h(wander) h(uncovered) with h(y) = 1 / (1 + (y / scale)²).

    rest, x : (vertex, xyz) the body at rest · in this frame, mesh unit
    n       : (vertex, xyz) its unit normals in this frame
    F       : (face, corner) of the body
    target  : the frame
    usual   : share that no frame covers, such as holes
    """
    there = projected(x, target.V, target.F)
    back = projected(target.V, x, F)
    origin = np.einsum("pk,pkx->px", back.share, rest[F[back.face]])
    wander = np.linalg.norm(np.einsum("vk,vkx->vx", there.share, origin[target.F[there.face]]) - rest, axis=1)
    alike = np.einsum("pk,pkx,px->p", back.share, n[F[back.face]], target.N)
    uncovered = 1.0 - float(((back.distance < COVERED * target.size) & (alike > ALIKE)).mean())
    stretch = stretches(rest, x, F)
    trust = (
        _half(there.distance, COVERED * target.size)
        * _half(np.log(np.maximum(stretch, np.finfo(float).tiny)), STRETCH)
        * _half(wander, RETURN * target.size)
        * float(_half(np.array(max(uncovered - usual, 0.0)), LEFT))
    )
    return VertexConfidence(there.distance, stretch, wander, trust, uncovered)


def _half(y: Floats, scale: float) -> Floats:
    return 1.0 / (1.0 + (y / scale) ** 2)
