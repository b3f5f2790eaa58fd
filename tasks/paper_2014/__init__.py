"""Steps II and III to the letter of the 2014 paper, where the default differs."""

from kinetree.tasks.paper_2014.aligned_frame import aligned_frame
from kinetree.tasks.paper_2014.aligned_reference import aligned_reference
from kinetree.tasks.paper_2014.annuli import annuli
from kinetree.tasks.paper_2014.arap import arap
from kinetree.tasks.paper_2014.bones import bones
from kinetree.tasks.paper_2014.cone_consistency import cone_consistency
from kinetree.tasks.paper_2014.cones import cones
from kinetree.tasks.paper_2014.cut_correspondence import cut_correspondence
from kinetree.tasks.paper_2014.cylinders import cylinders
from kinetree.tasks.paper_2014.geodesic_coordinates import geodesic_coordinates
from kinetree.tasks.paper_2014.geodesic_mapping import geodesic_mapping
from kinetree.tasks.paper_2014.integration import integration
from kinetree.tasks.paper_2014.interval_reference import interval_reference
from kinetree.tasks.paper_2014.kinematic_structure import kinematic_structure
from kinetree.tasks.paper_2014.transfer import transfer
from kinetree.tasks.paper_2014.transferred_alignment import transferred_alignment
from kinetree.tasks.paper_2014.transferred_projection import transferred_projection

STEP_2 = (
    geodesic_coordinates,
    interval_reference,
    geodesic_mapping,
    arap,
)
STEP_2_ALIGNED = (
    aligned_reference,
    aligned_frame,
)
"""In place of Step II: what Step III reads, from the default's alignment."""
STEP_3 = (
    cut_correspondence,
    cones,
    cone_consistency,
    annuli,
    integration,
    cylinders,
    bones,
    kinematic_structure,
)
TRANSFER = (
    transfer,
    transferred_alignment,
    transferred_projection,
)
PAPER_2014 = (*STEP_2, *STEP_3, *TRANSFER)
PAPER_2014_ALIGNED = (*STEP_2_ALIGNED, *STEP_3)
