"""Step II, the microscopic view: one reference mesh brought to every frame (2014, Sec. 5.2 and 5.3)."""

from kinetree.tasks.registration.alignment import alignment
from kinetree.tasks.registration.deformation_graph import deformation_graph
from kinetree.tasks.registration.frame_confidence import frame_confidence
from kinetree.tasks.registration.projection import projection
from kinetree.tasks.registration.recovery import recovery
from kinetree.tasks.registration.reference import reference
from kinetree.tasks.registration.refit import first_refit, second_refit, third_refit
from kinetree.tasks.registration.rigid_clusters import rigid_clusters
from kinetree.tasks.registration.roll_candidates import roll_candidates
from kinetree.tasks.registration.roll_correction import roll_correction
from kinetree.tasks.registration.roll_path import roll_path
from kinetree.tasks.registration.stiffness import first_stiffness, second_stiffness, third_stiffness
from kinetree.tasks.registration.tracking import tracking
from kinetree.tasks.registration.tracking_failures import tracking_failures

REGISTRATION = (
    reference,
    deformation_graph,
    tracking,
    tracking_failures,
    recovery,
    first_stiffness,
    first_refit,
    rigid_clusters,
    roll_candidates,
    roll_path,
    roll_correction,
    second_stiffness,
    second_refit,
    third_stiffness,
    third_refit,
    alignment,
    projection,
    frame_confidence,
)
