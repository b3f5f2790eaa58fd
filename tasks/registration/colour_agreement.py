"""Whether colours agree between the tracked frames."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.colour_agreement import ColourAgreement
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.first_fit import FirstFit
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.reference_colour import ReferenceColour
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.tasks.numerics.registration.colour_agreement import colour_agreement as measured
from kinetree.tasks.numerics.registration.colour_agreement import suffices
from kinetree.tasks.registration.pose import first_pose, graph, target


@task(among=Sequence)
def colour_agreement(
    deformation_graph: DeformationGraph,
    first_fit: Mapping[int, FirstFit],
    recovery: Recovery,
    mesh: Mapping[int, Mesh],
    vertex_colour: Mapping[int, VertexColour],
    reference_colour: ReferenceColour,
) -> ColourAgreement:
    """Measures how far the reference's colours explain those of the tracked frames, and whether they may count (ours)."""
    if not len(reference_colour.colour):
        return ColourAgreement.none()
    nodes = graph(deformation_graph)
    frames = tuple(t for t in mesh if t != deformation_graph.frame and len(vertex_colour[t].colour))
    share = np.empty(len(frames))
    for row, t in enumerate(frames):
        frame = target(mesh[t], deformation_graph, vertex_colour[t], reference_colour)
        share[row] = measured(nodes, first_pose(first_fit[t], recovery, t), frame)
    is_used = suffices(share)
    colour = reference_colour.colour if is_used else np.empty((0, 3), np.uint8)
    return ColourAgreement(frames=frames, share=share, is_used=is_used, colour=colour)
