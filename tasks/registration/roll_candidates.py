"""Limbs tried in other rolls about their own axis, in one frame."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.colour_agreement import ColourAgreement
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.refit import Refit
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.schemas.registration.stiffness import Stiffness
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.tasks.numerics.registration import roll_candidates as numerics
from kinetree.tasks.numerics.registration.stiffness import refit_pass
from kinetree.tasks.registration.pose import NO_AGREEMENT, NO_COLOUR, graph, pose, target


@task(over="pass/frame", along=DeformationGraph)
def roll_candidates(
    mesh: Mesh,
    deformation_graph: DeformationGraph,
    stiffness: Stiffness,
    refit: Refit | None,
    index: Index,
    vertex_colour: VertexColour = NO_COLOUR,
    colour_agreement: ColourAgreement = NO_AGREEMENT,
) -> RollCandidates:
    """Fits every limb as a rigid body from several rolls about its axis, in passes that search for lost roll (ours)."""
    if refit is None or not refit_pass(index[0]).roll:
        none = (0, numerics.RollCandidatesSettings().starts)
        return RollCandidates(
            angle=np.empty(none), misfit=np.empty(none), rotation=np.empty((*none, 3, 3)), place=np.empty((*none, 3))
        )
    cluster = stiffness.cluster.astype(np.int64)
    surface = target(mesh, deformation_graph, vertex_colour, colour_agreement)
    fits = numerics.roll_candidates(graph(deformation_graph), pose(refit), surface, cluster)
    return RollCandidates(**fits._asdict())
