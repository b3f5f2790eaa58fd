"""The initial model in another frame of its structure."""

from functools import lru_cache
from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2009.graph_deformation import GraphDeformation, GraphDeformationParams
from kinetree.schemas.paper_2009.initial_frames import InitialFrames
from kinetree.schemas.paper_2009.initial_model import InitialModel
from kinetree.schemas.paper_2009.perg import Perg
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.paper_2009 import model_fit as numerics
from kinetree.tasks.numerics.paper_2009.graph_deformation import Forces
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_frame import SkinnedBody


@task(over="structure/frame", along=InitialFrames)
def graph_deformation(
    index: Index,
    initial_model: InitialModel,
    perg: Perg,
    mesh: Mesh,
    leaves: Leaves,
    previous: GraphDeformation | None,
    params: GraphDeformationParams,
) -> GraphDeformation:
    """Draws the initial model to a frame's graph by external and internal forces (2009, Sec. 2.3.1, Eqs. 2 to 4)."""
    structure, frame = index
    fields = deformed_model(frame, initial_model, perg, mesh, leaves, previous, params)
    return GraphDeformation(structure=structure, **fields)


def deformed_model(
    frame: int,
    model: InitialModel,
    perg: Perg,
    mesh: Mesh,
    leaves: Leaves,
    previous: GraphDeformation | None,
    params: GraphDeformationParams,
) -> dict[str, Any]:
    """The fields of a deformation, from that of the frame before it in the traversal."""
    of_tree = {name: np.array(getattr(model, name)) for name in ("node", "parents", "joint", "branch", "end")}
    of_body = ("vertices", "faces", "bound", "weight", "joint", "parents")
    tree = numerics.Model(**of_tree, size=model.size)
    body = _body(*(np.asarray(getattr(model, name)).tobytes() for name in of_body))
    pose = numerics.at_rest(tree)
    surface = Target.of(np.array(mesh.vertices), mesh.faces, model.size, params.samples)
    if previous is not None:
        last = numerics.ModelPose(np.array(previous.position), np.array(previous.rotation), 0.0)
        target = _target_graph(perg, model, leaves, frame)
        pose = numerics.drawn(tree, last, target, _forces(params), branches=params.branches)
        if params.surface:
            pose = numerics.best_laid(tree, body, [pose, last], surface, params.hold)
    x = numerics.posed_surface(tree, body, pose)
    quality = numerics.model_quality(body, x, surface)
    of_surface = {name: getattr(quality, name) for name in ("residual", "stretch", "confidence", "uncovered")}
    return {**pose._asdict(), "vertices": x, **of_surface}


def _forces(params: GraphDeformationParams) -> Forces:
    """The forces as numerics have them."""
    names = ("sigma", "stiffness", "anchor", "step", "steps", "rest_length", "centred")
    return Forces(**{name: getattr(params, name) for name in names})


def _target_graph(perg: Perg, model: InitialModel, leaves: Leaves, frame: int) -> numerics.TargetGraph:
    """The frame's graph, with the leaf of the model that each of its branches ends in."""
    row = leaves.rows[:, leaves.frames.index(frame)].astype(np.int64)
    leaf = np.full(len(perg.end), -1)
    for number, track in enumerate(model.track.tolist()):
        if track >= 0 and row[track] >= 0:
            leaf[row[track]] = number
    node = np.array(perg.node)
    return numerics.TargetGraph(node, leaf, numerics.branch_lines(node, perg.edge, np.array(perg.branch), np.array(perg.end)))


@lru_cache(maxsize=2)
def _body(vertices: bytes, faces: bytes, bound: bytes, weight: bytes, joint: bytes, parents: bytes) -> SkinnedBody:
    """One body for all frames of a structure that this process deforms, by the bytes of what it is made from."""
    V, rest = (np.frombuffer(b).reshape(-1, 3) for b in (vertices, joint))
    F, nodes = np.frombuffer(faces, np.int64).reshape(-1, 3), np.frombuffer(bound, np.int64).reshape(len(V), -1)
    share = np.frombuffer(weight).reshape(len(V), -1)
    return SkinnedBody.of(V, F, nodes, share, rest, np.frombuffer(parents, np.int64).copy())
