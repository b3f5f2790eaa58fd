"""The operations of the shelf, apart from the package: a plan looks for a truth alone, and imports none of the others."""

from kinetree.tasks.results.alignment_figures import alignment_figures
from kinetree.tasks.results.appearance import appearance
from kinetree.tasks.results.assumed_joints import assumed_joints
from kinetree.tasks.results.blender import blender
from kinetree.tasks.results.bvh import bvh
from kinetree.tasks.results.c3d import c3d
from kinetree.tasks.results.coarse_mesh import coarse_mesh
from kinetree.tasks.results.complete_skeleton import complete_skeleton
from kinetree.tasks.results.cut_figures import cut_figures
from kinetree.tasks.results.derivation_figures import derivation_figures
from kinetree.tasks.results.evaluation import evaluation
from kinetree.tasks.results.evaluation_figures import evaluation_figures
from kinetree.tasks.results.excerpt import excerpt
from kinetree.tasks.results.frame_truth import frame_truth
from kinetree.tasks.results.glb import glb
from kinetree.tasks.results.known_truth import known_truth
from kinetree.tasks.results.motion_figures import motion_figures
from kinetree.tasks.results.named_figures import named_figures
from kinetree.tasks.results.outcomes import outcomes
from kinetree.tasks.results.paper_figures import paper_figures
from kinetree.tasks.results.played_body import played_body
from kinetree.tasks.results.ply import ply
from kinetree.tasks.results.reeb_figures import reeb_figures
from kinetree.tasks.results.report import report
from kinetree.tasks.results.rignet import rignet
from kinetree.tasks.results.segmentation import segmentation
from kinetree.tasks.results.sequence_figures import sequence_figures
from kinetree.tasks.results.sequence_table import sequence_table
from kinetree.tasks.results.skeleton_figures import skeleton_figures
from kinetree.tasks.results.skeleton_json import skeleton_json
from kinetree.tasks.results.structure_figures import structure_figures
from kinetree.tasks.results.surface_error import surface_error
from kinetree.tasks.results.tables import tables
from kinetree.tasks.results.topology_figures import topology_figures
from kinetree.tasks.results.trc import trc
from kinetree.tasks.results.tree_figures import tree_figures
from kinetree.tasks.results.truth import truth
from kinetree.tasks.results.usd import usd
from kinetree.tasks.results.verdict import verdict

RESULTS = (
    truth,
    known_truth,
    evaluation,
    complete_skeleton,
    assumed_joints,
    appearance,
    glb,
    bvh,
    skeleton_json,
    segmentation,
    tables,
    ply,
    rignet,
    usd,
    blender,
    trc,
    c3d,
    surface_error,
    verdict,
    frame_truth,
    excerpt,
    coarse_mesh,
    topology_figures,
    skeleton_figures,
    tree_figures,
    motion_figures,
    alignment_figures,
    evaluation_figures,
    played_body,
    report,
)
FIGURES = (cut_figures, derivation_figures, named_figures, structure_figures)
FIGURES_2009 = (reeb_figures,)
FIGURES_2014 = (paper_figures,)
OVER_SEQUENCES = (outcomes, sequence_figures, sequence_table)
"""What sums up a data set."""
