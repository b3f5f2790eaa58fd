"""The graph of one frame inside the body."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2009.perg import Perg, PergParams
from kinetree.schemas.paper_2009.reeb_graph import ReebGraph
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.paper_2009 import perg as numerics
from kinetree.tasks.numerics.paper_2009.graph_loops import branch_degrees, end_branches
from kinetree.tasks.numerics.paper_2009.reeb_graph import ReebGraph as Graph


@task(over="frame")
def perg(mesh: Mesh, reeb_graph: ReebGraph, extrema: Extrema, params: PergParams) -> Perg:
    """Replaces what is outside the body by finer nodes, until nodes and edges lie inside (2009, Sec. 2.1; Fig. 1)."""
    stored = {name: np.array(values) for name, values in reeb_graph.arrays().items()}
    graph = numerics.perg(
        np.array(mesh.vertices),
        mesh.faces,
        Graph(**stored),
        extrema.vertices.astype(np.int64),
        start=min(params.start, int(stored["level"].max())),
        least_loop=params.least_loop,
        moved_inside=params.outside == "moved",
        prune=params.branches == "leaves",
    )
    count = len(graph.node)
    branch, degrees = end_branches(count, graph.edge, graph.end), branch_degrees(count, graph.edge)
    return Perg(**graph._asdict(), branch=branch, degrees=degrees)
