"""The mesh of the finished skeleton in one frame, in the form in which every method leaves it."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.geometry.normals import face_areas, smoothed_normals
from kinetree.tasks.numerics.paper_2014.transfer import completed
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.frame_confidence import stretches
from kinetree.tasks.numerics.registration.vertex_confidence import vertex_confidence


@task(over="frame")
def transferred_alignment(
    landing: tuple[Transfer, ...], mesh: Mesh, skeleton: Skeleton, connectivity: Connectivity
) -> Alignment:
    """Brings the skeleton's mesh to every frame over the interval's own and the cuts (ours, for 2014, Sec. 6.1.3).

    What has no way there goes with what lies around it, and is not trusted.
    """
    (mine,) = landing  # a frame is in one interval
    known = np.isfinite(mine.place[:, 0])
    rest, F = np.array(skeleton.vertices), np.array(skeleton.faces, np.int64)
    x = completed(rest, np.array(mine.place))
    if connectivity.fixed:
        one = known.astype(np.float64)
        return Alignment(vertices=x, residual=0.0 * one, stretch=stretches(rest, x, F), trust=one, uncovered=0.0)
    target = Target.of(np.array(mesh.vertices), mesh.faces, float(np.sqrt(face_areas(rest, F).sum())))
    found = vertex_confidence(rest, x, smoothed_normals(x, F), F, target, usual=1.0)
    trust = found.trust * known
    return Alignment(
        vertices=x,
        residual=found.residual,
        stretch=found.stretch,
        trust=trust,
        uncovered=found.uncovered,
        distance=float(np.median(found.residual)),
        doubted=float((trust < 0.5).mean()),
    )
