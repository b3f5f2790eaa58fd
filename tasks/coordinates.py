"""Geodesic coordinates of one frame's vertices."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.coordinates import Coordinates, CoordinatesParams
from kinetree.schemas.mesh import Mesh
from kinetree.schemas.tips import Tips
from kinetree.tasks.numerics.mesoscopic.coordinates import geodesic_coordinates


@task(over="frame")
def coordinates(mesh: Mesh, tips: Tips, params: CoordinatesParams) -> Coordinates:
    """Measures the distance of every vertex to each tip over the surface (2014, Sec. 5.2, Eq. 4)."""
    distance = geodesic_coordinates(np.array(mesh.vertices), mesh.faces, tips.vertices, params.exact)
    return Coordinates(tips=tips.vertices, distance=distance)
