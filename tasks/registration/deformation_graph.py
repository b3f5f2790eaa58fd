"""The reference mesh as a deformation graph."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.deformation_graph import DeformationGraph, DeformationGraphParams
from kinetree.schemas.registration.reference import Reference
from kinetree.tasks.numerics.registration import deformation_graph as numerics
from kinetree.tasks.numerics.registration.stiffness import refit_pass


@task()
def deformation_graph(reference: Reference, params: DeformationGraphParams) -> DeformationGraph:
    """Covers the reference mesh with nodes, binds its vertices to them and links neighbours (ours, for 2014, Sec. 5.2)."""
    if reference.fixed:  # every vertex is followed by the input itself: nothing to fit, no passes
        return _empty(reference)
    # with a node on every vertex nothing lies between nodes, and no edge would link them
    nodes = max(min(params.nodes, len(reference.vertices) // 2), 1)
    settings = graph_settings(params)._replace(nodes=nodes)
    made = numerics.deformation_graph(np.array(reference.vertices), np.array(reference.faces), settings)
    return DeformationGraph(
        frame=reference.frame,
        passes=params.passes,
        searched=tuple(p for p in range(1, params.passes) if refit_pass(p).roll),
        vertices=made.V,
        faces=made.F,
        normals=made.N,
        nodes=made.node,
        bound=made.bound,
        weight=made.weight,
        edges=made.edge,
        samples=made.sample,
        size=made.size,
        stems=np.array(reference.stems),
        degree=np.diff(made.start),
        ring=made.ring,
        blocks=made.pair,
        block_of_vertex=made.of_vertex,
        block_of_edge=made.of_edge,
    )


def graph_settings(params: DeformationGraphParams) -> numerics.DeformationGraphSettings:
    """How finely a reference of any size is covered."""
    return numerics.DeformationGraphSettings(params.nodes, params.finest, params.thick, params.strut, params.samples)


def _empty(reference: Reference) -> DeformationGraph:
    """A graph without nodes and passes."""
    whole, real = np.int32, np.float64
    return DeformationGraph(
        frame=reference.frame,
        passes=0,
        vertices=np.empty((0, 3), real),
        faces=np.empty((0, 3), whole),
        normals=np.empty((0, 3), real),
        nodes=np.empty(0, whole),
        bound=np.empty((0, 4), whole),
        weight=np.empty((0, 4), real),
        edges=np.empty((0, 2), whole),
        samples=np.empty(0, whole),
        size=reference.size,
        stems=np.empty((0, *reference.stems.shape[1:]), real),
        degree=np.empty(0, whole),
        ring=np.empty(0, whole),
        blocks=np.empty((0, 2), whole),
        block_of_vertex=np.empty((0, 6), whole),
        block_of_edge=np.empty(0, whole),
    )
