"""Input meshes with few vertices, each with the point of the reference that it belongs to."""

from collections.abc import Mapping

import numpy as np

from kinetree.schemas.array import Ints
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.coarse_mesh import CoarseMesh
from kinetree.tasks.numerics.geometry.decimation import decimated


def alike(faces: Mapping[int, Ints]) -> tuple[int, ...]:
    """For every frame the first of the frames up to it that all have its faces.

    faces : by source frame number, in the order of the frames
    """
    first: list[int] = []
    last: Ints | None = None
    for frame, F in faces.items():
        first.append(first[-1] if last is not None and np.array_equal(F, last) else frame)
        last = F
    return tuple(first)


def coarse(mesh: Mesh, projection: Projection, previous: CoarseMesh | None, count: int) -> CoarseMesh:
    """A mesh with about `count` vertices, or with those of a coarse mesh that has the same faces.

    returns : its `kept` and `faces` are empty where they are those of `previous`
    """
    V = np.asarray(mesh.vertices)
    vertex, faces = decimated(np.array(V), mesh.faces, count) if previous is None else (previous.kept, None)
    face, corner = np.full(len(V), -1, np.int32), np.zeros(len(V), np.int32)
    known = (projection.face >= 0) & (mesh.vertex_of_input >= 0)
    at = mesh.vertex_of_input[known]
    face[at], corner[at] = projection.face[known], np.argmax(projection.share, axis=1)[known]
    return CoarseMesh(
        size=len(V),
        limit=count,
        extent=tuple(np.ptp(V, axis=0).tolist()),
        vertices=V[vertex],
        reference_face=face[vertex],
        reference_corner=corner[vertex],
        kept=np.zeros(0, np.int32) if faces is None else vertex,
        faces=np.zeros((0, 3), np.int32) if faces is None else faces,
    )


def coarse_meshes(meshes: Mapping[int, Mesh], projections: Mapping[int, Projection], count: int) -> dict[int, CoarseMesh]:
    """The coarse meshes of some frames, those with the same faces decimated in the same way.

    meshes, projections : by source frame number, of the same frames
    """
    coarse_of: dict[int, CoarseMesh] = {}
    for frame, first in zip(meshes, alike({f: m.faces for f, m in meshes.items()}), strict=True):
        coarse_of[frame] = coarse(meshes[frame], projections[frame], coarse_of.get(first), count)
    return coarse_of
