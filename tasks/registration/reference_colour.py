"""The colours of the reference mesh."""

from collections.abc import Mapping

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.reference_colour import ReferenceColour
from kinetree.schemas.registration.vertex_colour import VertexColour


@task(among=Sequence)
def reference_colour(reference: Reference, vertex_colour: Mapping[int, VertexColour]) -> ReferenceColour:
    """Takes the colours of the frame that the reference mesh is from (ours)."""
    colour = vertex_colour[reference.frame].colour
    if reference.fixed or len(colour) != len(reference.vertices):
        return ReferenceColour.none()
    return ReferenceColour(colour=colour)
