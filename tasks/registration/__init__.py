"""Step II, the microscopic view: one reference mesh brought to every frame (2014, Sec. 5.2 and 5.3)."""

from kinetree.tasks.registration.alignment import alignment
from kinetree.tasks.registration.colour_agreement import colour_agreement
from kinetree.tasks.registration.deformation_graph import deformation_graph
from kinetree.tasks.registration.first_fit import first_fit
from kinetree.tasks.registration.frame_confidence import frame_confidence
from kinetree.tasks.registration.projection import projection
from kinetree.tasks.registration.recovery import recovery
from kinetree.tasks.registration.reference import reference
from kinetree.tasks.registration.reference_colour import reference_colour
from kinetree.tasks.registration.refit import refit
from kinetree.tasks.registration.roll import roll
from kinetree.tasks.registration.roll_candidates import roll_candidates
from kinetree.tasks.registration.stiffness import stiffness
from kinetree.tasks.registration.take_entries import take_entries
from kinetree.tasks.registration.tracking import tracking
from kinetree.tasks.registration.tracking_order import tracking_order
from kinetree.tasks.registration.vertex_colour import vertex_colour

REGISTRATION = (
    vertex_colour,
    reference,
    reference_colour,
    deformation_graph,
    take_entries,
    tracking_order,
    tracking,
    first_fit,
    recovery,
    colour_agreement,
    stiffness,
    roll_candidates,
    roll,
    refit,
    alignment,
    projection,
    frame_confidence,
)
ALIGNED = tuple(task for task in REGISTRATION if task not in (reference, tracking))
"""From any reference and its tracked frames to the alignment."""
