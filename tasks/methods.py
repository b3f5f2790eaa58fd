"""The papers' table of contents: every operation, in the order in which the papers tell it.

MESOSCOPIC: Tree-structured mesoscopic surface characterization (Mukasa, Nobuhara, Tung, Matsuyama 2014), the default, with
what was measured to be better in place of some of its steps. MESOSCOPIC_2014: the same to the paper's letter. Both begin
with MACROSCOPIC.
"""

from kinetree.pipeline.graph import Graph
from kinetree.tasks.input.connectivity import connectivity
from kinetree.tasks.input.mesh import mesh
from kinetree.tasks.input.sequence import sequence
from kinetree.tasks.input.source import source
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
from kinetree.tasks.paper_2014.limb import limb
from kinetree.tasks.paper_2014.paper_figures import paper_figures
from kinetree.tasks.paper_2014.transfer import transfer
from kinetree.tasks.paper_2014.transferred_alignment import transferred_alignment
from kinetree.tasks.paper_2014.transferred_projection import transferred_projection
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
from kinetree.tasks.results.bvh import bvh
from kinetree.tasks.results.evaluation import evaluation
from kinetree.tasks.results.glb import glb
from kinetree.tasks.results.ply import ply
from kinetree.tasks.results.report import report
from kinetree.tasks.results.rignet import rignet
from kinetree.tasks.results.segmentation import segmentation
from kinetree.tasks.results.skeleton_json import skeleton_json
from kinetree.tasks.results.structure_figures import structure_figures
from kinetree.tasks.results.tables import tables
from kinetree.tasks.results.truth import truth
from kinetree.tasks.results.usd import usd
from kinetree.tasks.structure.kinematic_tree import kinematic_tree
from kinetree.tasks.structure.pose_refinement import pose_refinement
from kinetree.tasks.structure.rigid_parts import rigid_parts
from kinetree.tasks.structure.skeleton import skeleton
from kinetree.tasks.structure.traces import traces
from kinetree.tasks.topology.correlation import correlation
from kinetree.tasks.topology.extrema import extrema
from kinetree.tasks.topology.geodesics import geodesics
from kinetree.tasks.topology.intervals import intervals
from kinetree.tasks.topology.leaves import leaves
from kinetree.tasks.topology.mu_histogram import mu_histogram
from kinetree.tasks.topology.up_direction import up_direction

MACROSCOPIC = (
    source,  # Sec. 3
    sequence,
    mesh,
    connectivity,  # Sec. 7
    geodesics,  # Sec. 4, Eq. 1
    mu_histogram,
    correlation,  # Eq. 2
    extrema,  # Sec. 5.1
    intervals,  # Sec. 4
    leaves,  # Sec. 5.1, Eq. 3
    up_direction,
)

RESULTS = (
    truth,
    evaluation,  # Sec. 7
    glb,
    bvh,
    skeleton_json,
    segmentation,
    tables,
    ply,
    rignet,
    usd,
)

MESOSCOPIC = (
    *MACROSCOPIC,
    reference,  # Sec. 5.3
    deformation_graph,  # for Sec. 5.2
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
    alignment,  # Sec. 5.3
    projection,
    frame_confidence,
    rigid_parts,  # Sec. 6.1 and 6.2
    kinematic_tree,  # Sec. 6.3
    pose_refinement,  # for Sec. 7.3
    skeleton,
    traces,
    *RESULTS,
    structure_figures,  # Figs. 7, 11 and 15
    report,
)

MESOSCOPIC_2014 = (
    *MACROSCOPIC,
    geodesic_coordinates,  # Sec. 5.2, Eq. 4
    interval_reference,  # Sec. 5.3
    geodesic_mapping,  # Eqs. 5 and 6
    arap,
    cut_correspondence,  # for Sec. 6.1.1
    cones,  # Sec. 6.1.1.1
    cone_consistency,  # Sec. 6.1.1.2 to 6.1.1.4, Eqs. 7 and 8
    limb,
    annuli,  # Sec. 6.1.2, Eqs. 9 to 12
    integration,  # Sec. 6.1.3
    cylinders,  # Sec. 6.2
    bones,  # Sec. 6.3
    kinematic_structure,
    transfer,
    transferred_alignment,
    transferred_projection,
    *RESULTS,
    paper_figures,  # Figs. 7, 11, 13 and 15
    report,
)

METHODS = {"mesoscopic": Graph.of(MESOSCOPIC), "mesoscopic-2014": Graph.of(MESOSCOPIC_2014)}
"""The graph of each method, the default first; checked when this module is imported."""
