"""The mesh of the skeleton in one frame, as the alignment that every method ends with."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.geometry.normals import face_areas
from kinetree.tasks.numerics.paper_2014.alignment_quality import alignment_quality
from kinetree.tasks.numerics.paper_2014.transferred_alignment import completed


@task(over="frame")
def transferred_alignment(transfers: tuple[Transfer, ...], mesh: Mesh, skeleton: Skeleton) -> Alignment:
    """Brings the skeleton's mesh to every frame over the interval's reference and the cuts (ours, for 2014, Sec. 6.1.3).

    A vertex that no map over the cuts reaches moves with the vertices around it and has confidence 0.
    """
    (transfer,) = transfers  # a frame is in one interval
    known = np.isfinite(transfer.model_position[:, 0])
    rest, F = np.array(skeleton.vertices), np.array(skeleton.faces, np.int64)
    x = completed(rest, np.array(transfer.model_position))
    frame_V, frame_F = np.array(mesh.vertices), mesh.faces.astype(np.int64)
    size = float(np.sqrt(face_areas(rest, F).sum()))
    quality = alignment_quality(rest, x, F, frame_V, frame_F, size, tracked=transfer.tracked)
    confidence = quality.confidence * known
    return Alignment(
        vertices=x,
        residual=quality.residual,
        stretch=quality.stretch,
        confidence=confidence,
        uncovered=quality.uncovered,
        distance=float(np.median(quality.residual)),
        unreliable=float((confidence < 0.5).mean()),
    )
