"""Steps II and III to the letter of the 2014 paper, where the default differs."""

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

PAPER_2014 = (
    geodesic_coordinates,
    interval_reference,
    geodesic_mapping,
    arap,
    cut_correspondence,
    cones,
    cone_consistency,
    annuli,
    integration,
    cylinders,
    bones,
    kinematic_structure,
    transfer,
    transferred_alignment,
    transferred_projection,
)
