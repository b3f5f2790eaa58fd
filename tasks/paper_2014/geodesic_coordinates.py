"""Geodesic coordinates of one frame's vertices."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.geodesic_coordinates import GeodesicCoordinates
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.paper_2014 import geodesic_coordinates as numerics


@task(over="frame")
def geodesic_coordinates(mesh: Mesh, extrema: Extrema) -> GeodesicCoordinates:
    """Measures the geodesic distance of every vertex to each extremum (2014, Sec. 5.2, Eq. 4)."""
    distance = numerics.geodesic_coordinates(np.array(mesh.vertices), mesh.faces, extrema.vertices)
    return GeodesicCoordinates(extrema=extrema.vertices, distance=distance)
