"""An interval's reference in one of its frames: as rigid as possible where the geodesic mapping wants it."""

from functools import lru_cache

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.arap import Arap, ArapParams
from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.paper_2014.arap import Factorised, soft_weights
from kinetree.tasks.numerics.paper_2014.stillness import rigid_gap
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.frame_confidence import stretches
from kinetree.tasks.numerics.registration.vertex_confidence import vertex_confidence


@task(over="interval/frame")
def arap(
    middle: IntervalReference, matching: GeodesicMapping, mesh: Mesh, connectivity: Connectivity, params: ArapParams
) -> Arap:
    """Deforms the reference as rigidly as possible, softly held where the mapping takes its vertices (2014, Sec. 5.3)."""
    rest, F = np.array(middle.vertices), middle.faces.astype(np.int64)
    if connectivity.fixed:
        x = np.array(mesh.vertices)
        gap, one = rigid_gap(rest, x, np.array(middle.area), x, F), np.ones(len(x))
        return Arap(vertices=x, residual=0.0 * one, stretch=stretches(rest, x, F), trust=one, uncovered=0.0, moved=gap)
    x = _deformed(middle, matching, mesh, params)
    target = Target.of(np.array(mesh.vertices), mesh.faces, middle.size)
    # the mapping leaves much uncovered everywhere: that is no sign of a lost limb, and `uncovered` tells it
    found = vertex_confidence(rest, x, smoothed_normals(x, F), F, target, usual=1.0)
    return Arap(
        vertices=x,
        residual=found.residual,
        stretch=found.stretch,
        trust=found.trust,
        uncovered=found.uncovered,
        moved=rigid_gap(rest, x, np.array(middle.area), target.V, target.F.astype(np.int64)),
    )


def _deformed(middle: IntervalReference, matching: GeodesicMapping, mesh: Mesh, params: ArapParams) -> Floats:
    """A frame in which nothing is matched has the reference as it is, which nobody will trust."""
    held = matching.image >= 0
    if not held.any():
        return np.array(middle.vertices)
    soft = soft_weights(np.where(held, middle.area, 0.0), params.length * middle.size)
    system = _factorised(middle.vertices.tobytes(), middle.faces.tobytes(), soft.tobytes())
    wanted = np.where(held[:, None], mesh.vertices[matching.image], middle.vertices)
    return system.solve(wanted, steps=params.steps, tolerance=params.tolerance).x


@lru_cache(maxsize=2)
def _factorised(vertices: bytes, faces: bytes, soft: bytes) -> Factorised:
    """One factorisation for all frames of an interval that this process deforms, known by what it is made of."""
    F = np.frombuffer(faces, np.int32).reshape(-1, 3).astype(np.int64)
    return Factorised.of(np.frombuffer(vertices).reshape(-1, 3), F, np.frombuffer(soft))
