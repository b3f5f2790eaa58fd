"""The graph of an initial frame with the surface that follows it."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2009.initial_frames import InitialFrames
from kinetree.schemas.paper_2009.initial_model import InitialModel, InitialModelParams
from kinetree.schemas.paper_2009.perg import Perg
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.arrays import Ints
from kinetree.tasks.numerics.paper_2009.graph_body import graph_body


@task(over="structure")
def initial_model(
    index: Index,
    initial_frames: InitialFrames,
    pergs: Mapping[int, Perg],
    meshes: Mapping[int, Mesh],
    extrema: Mapping[int, Extrema],
    leaves: Leaves,
    params: InitialModelParams,
) -> InitialModel:
    """Makes the graph of the initial frame a tree of nodes that carry its surface (2009, Sec. 2.3.1)."""
    at = int(initial_frames.initial[index[0]])
    frame = initial_frames.frames[at]
    graph, mesh = pergs[frame], meshes[frame]
    V, F = np.array(mesh.vertices), mesh.faces.astype(np.int64)
    of_graph = {name: np.array(getattr(graph, name)) for name in ("node", "edge", "loop", "area", "end", "of_vertex")}
    spacing = params.spacing * extrema[frame].size
    body = graph_body(V, F, **of_graph, smoothing=params.smoothing, spacing=spacing)
    return InitialModel(
        frame=frame,
        size=extrema[frame].size,
        vertices=V,
        faces=F,
        leaf_vertex=extrema[frame].vertices,
        track=_tracks(leaves, at, len(body.end)),
        **body._asdict(),
    )


def _tracks(leaves: Leaves, at: int, count: int) -> Ints:
    """(extremum,) the limb that each extremum of a frame is, −1 for none."""
    row = leaves.rows[:, at].astype(np.int64)
    track = np.full(count, -1)
    tracked = np.flatnonzero(row >= 0)
    track[row[tracked]] = tracked
    return track
