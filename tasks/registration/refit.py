"""Every frame fitted again by itself, with the stiffness that the sequence taught, pass after pass."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index, Ints
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.colour_agreement import ColourAgreement
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.first_fit import FirstFit
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.refit import Refit
from kinetree.schemas.registration.roll import Roll
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.schemas.registration.stiffness import Stiffness
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.tasks.numerics.registration.deformation import fit
from kinetree.tasks.numerics.registration.roll import frame_rolls
from kinetree.tasks.numerics.registration.stiffness import refit_pass
from kinetree.tasks.registration.pose import NO_AGREEMENT, NO_COLOUR, first_pose, graph, pose, rolled_pose, target


@task(over="pass/frame", along=DeformationGraph)
def refit(
    mesh: Mesh,
    deformation_graph: DeformationGraph,
    first_fit: FirstFit,
    recovery: Recovery,
    stiffness: Stiffness,
    candidates: tuple[RollCandidates, ...],
    roll: Roll,
    previous: Refit | None,
    index: Index,
    vertex_colour: VertexColour = NO_COLOUR,
    colour_agreement: ColourAgreement = NO_AGREEMENT,
) -> Refit:
    """Fits a frame again from its pose of the pass before, stiff where the sequence never bent (ours)."""
    number, frame = index
    nodes = graph(deformation_graph)
    if previous is None:
        start = first_pose(first_fit, recovery, frame)
    else:
        start = pose(previous)
        for fits in candidates:
            start = rolled_pose(nodes, previous, fits, stiffness, _chosen(roll, fits, frame))
    if frame != deformation_graph.frame:  # the reference stays what it is
        surface = target(mesh, deformation_graph, vertex_colour, colour_agreement)
        start = fit(nodes, start, surface, refit_pass(number).fit, roll.stiffness.copy()).pose
    return Refit(rotation=start.rotation, translation=start.translation)


def _chosen(roll: Roll, candidates: RollCandidates, frame: int) -> Ints:
    """(limb,) the candidates of a frame: those of the paths over the sequence, or its own where nothing is learned from it."""
    row = roll.row(frame)
    if row is not None:
        return row
    return frame_rolls(np.array(candidates.angle), np.array(candidates.misfit), roll.rolls).astype(np.int32)
