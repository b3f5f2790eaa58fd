"""The Reeb graph of μ on one frame, in all resolutions."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2009.reeb_graph import ReebGraph, ReebGraphParams
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.tasks.numerics.paper_2009 import reeb_graph as numerics


@task(over="frame")
def reeb_graph(mesh: Mesh, geodesics: Geodesics, params: ReebGraphParams) -> ReebGraph:
    """Joins the pieces of the surface in bands of μ, in 2, 4, 8 … bands (2009, Sec. 2.1; Hilaga 2001)."""
    inside = ~np.isnan(geodesics.mu)
    F = mesh.faces[inside[mesh.faces].all(axis=1)]
    graph = numerics.reeb_graph(np.array(mesh.vertices), F, np.where(inside, geodesics.mu, 0.0), params.levels)
    return ReebGraph(**graph._asdict())
