"""An interval's reference in one of its frames, as rigid as possible, with the geodesic mapping as soft constraint."""

from functools import lru_cache

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.arap import Arap, ArapParams
from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.paper_2014.alignment_quality import alignment_quality
from kinetree.tasks.numerics.paper_2014.arap import Factorised, soft_weights
from kinetree.tasks.numerics.paper_2014.rigid_residual import rigid_residual


@task(over="interval/frame")
def arap(interval_reference: IntervalReference, geodesic_mapping: GeodesicMapping, mesh: Mesh, params: ArapParams) -> Arap:
    """Deforms the reference as rigidly as possible towards the images of its vertices (2014, Sec. 5.3)."""
    reference, tracked = interval_reference, interval_reference.tracked
    rest, F = np.array(reference.vertices), reference.faces.astype(np.int64)
    frame_V, frame_F = np.array(mesh.vertices), mesh.faces.astype(np.int64)
    x = frame_V if tracked else _deformed(reference, geodesic_mapping, mesh, params)
    quality = alignment_quality(rest, x, F, frame_V, frame_F, reference.size, tracked=tracked)
    return Arap(
        vertices=x,
        residual=quality.residual,
        stretch=quality.stretch,
        confidence=quality.confidence,
        uncovered=quality.uncovered,
        rigid_residual=rigid_residual(rest, x, np.array(reference.area), frame_V, frame_F),
    )


def _deformed(reference: IntervalReference, mapping: GeodesicMapping, mesh: Mesh, params: ArapParams) -> Floats:
    """The reference's vertices in the frame; as in the reference, and without confidence, if no vertex has an image."""
    mapped = mapping.image >= 0
    if not mapped.any():
        return np.array(reference.vertices)
    soft = soft_weights(np.where(mapped, reference.area, 0.0), params.length * reference.size)
    system = _factorised(reference.vertices.tobytes(), reference.faces.tobytes(), soft.tobytes())
    target = np.where(mapped[:, None], mesh.vertices[mapping.image], reference.vertices)
    return system.solve(target, steps=params.steps, tolerance=params.tolerance).x


@lru_cache(maxsize=2)
def _factorised(vertices: bytes, faces: bytes, soft: bytes) -> Factorised:
    """One factorisation for all frames of an interval that this process deforms, by the bytes of what it is made from."""
    F = np.frombuffer(faces, np.int32).reshape(-1, 3).astype(np.int64)
    return Factorised.of(np.frombuffer(vertices).reshape(-1, 3), F, np.frombuffer(soft))
