"""Limbs tried in other rolls about their own axis, in one frame."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.colour_agreement import ColourAgreement
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.refit import Refit
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.schemas.registration.stiffness import Stiffness
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.tasks.numerics.registration import roll_candidates as numerics
from kinetree.tasks.registration.pose import NO_AGREEMENT, NO_COLOUR, graph, pose, target


@task(over="pass/search/frame", along=DeformationGraph)
def roll_candidates(
    mesh: Mesh,
    deformation_graph: DeformationGraph,
    stiffness: Stiffness,
    refit: Refit | None,
    vertex_colour: VertexColour = NO_COLOUR,
    colour_agreement: ColourAgreement = NO_AGREEMENT,
) -> RollCandidates:
    """Fits every limb as a rigid body from several rolls about its axis, before passes that search for lost roll (ours)."""
    if refit is None:
        raise ValueError("rolls are tried from the poses of the pass before: none is searched before pass 1")
    nodes, cluster = graph(deformation_graph), stiffness.cluster.astype(np.int64)
    surface = target(mesh, deformation_graph, vertex_colour, colour_agreement)
    fits = numerics.roll_candidates(nodes, pose(refit), surface, cluster)
    return RollCandidates(**fits._asdict())
