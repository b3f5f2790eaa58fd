"""One frame of the skeleton held against the truth, so that frames are compared side by side."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index, Ints
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.frame_truth import FrameTruth
from kinetree.schemas.results.known_truth import KnownTruth
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results.evaluation import body
from kinetree.tasks.numerics.results.evaluation.parts import leading_parts
from kinetree.tasks.numerics.results.units import unit_factor
from kinetree.tasks.results.truth import true_carriers

PAIRS = ("part", "carrier", "bone_end", "count")
"""Joint of the skeleton, true joint and end of its bone that carry the same vertices, and how many."""


@task(over="true")
def frame_truth(
    skeleton: Skeleton,
    known_truth: KnownTruth,
    source: Mapping[int, Source],
    mesh: Mapping[int, Mesh],
    projection: Mapping[int, Projection],
    index: Index,
) -> FrameTruth:
    """Counts the vertices of each pair of parts in a frame and measures the body at the true joints (2014, Sec. 7.1)."""
    (frame,), s = index, skeleton
    if frame not in s.frames:
        nothing = dict.fromkeys(PAIRS, np.zeros(0, np.int64))
        return FrameTruth(frame=frame, known=False, **nothing, inside=True, radius=np.zeros(0))
    t, at = s.frames.index(frame), known_truth.frames.index(frame)
    y = known_truth.positions[at] * unit_factor(known_truth.unit, s.unit, known_truth.source)
    V = body.blended_skin(s.vertices, s.influence, s.weight, s.rest, s.rotation[t], s.positions[t])
    carriers = None
    if frame in mesh:
        carriers = true_carriers(known_truth, source[frame], mesh[frame].vertices, frame, s.unit)
    pairs = (
        dict.fromkeys(PAIRS, np.zeros(0, np.int64))
        if carriers is None
        else _counted(s, mesh[frame], projection[frame], carriers)
    )
    return FrameTruth(
        frame=frame,
        known=carriers is not None,
        **pairs,
        inside=body.joints_fit(V, y),
        radius=body.local_radii(V, y),
    )


def _counted(s: Skeleton, mesh: Mesh, at: Projection, carriers: tuple[Ints, Ints]) -> dict[str, Ints]:
    """What carries the vertices of the user's file, in the skeleton and in truth."""
    vertex = mesh.vertex_of_input
    known = (vertex >= 0) & (at.face >= 0)
    part = leading_parts(s.label, s.influence, s.weight)
    mine = part[s.faces[at.face[known], at.share[known].argmax(axis=1)]]
    joint, end = (values[vertex[known]] for values in carriers)
    triples, count = np.unique(np.stack([mine, joint, end]), axis=1, return_counts=True)
    return dict(zip(PAIRS, (*triples, count), strict=True))
