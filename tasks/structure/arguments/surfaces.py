"""The frames' surfaces, prepared so that pieces of the body are laid on them."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.reference import Reference
from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.hinged_piece import SAMPLE


def area_of(reference: Reference) -> tuple[Floats, Ints, Floats]:
    """(vertex, xyz) mesh unit · (face, corner) · (vertex,) area, mesh unit², of the reference mesh."""
    V, F = np.array(reference.vertices), np.array(reference.faces, np.int64)
    return V, F, surface_areas(V, F)


def prepared(mesh: Mapping[int, Mesh], frames: Sequence[int], size: float) -> Callable[[int], Target]:
    """Gives a frame's surface by its place among the frames.

    size : root of the body's area, mesh unit
    """

    def surface(t: int) -> Target:
        here = mesh[frames[t]]
        return Target.of(np.array(here.vertices, np.float64), np.array(here.faces, np.int64), size, SAMPLE)

    return surface
