"""The papers' table of contents: a method is a sum of shelves, each of which lists its operations in the papers' order.

mesoscopic: Tree-structured mesoscopic surface characterization (Mukasa, Nobuhara, Tung, Matsuyama 2014), the default, with
what was measured to be better in place of some of its steps. mesoscopic-2014: the same to the paper's letter.
mesoscopic-2014-aligned: the paper's Step III to the letter, on the default's alignment.
reeb: Finding kinematic structure in time series volume data (Mukasa, Nobuhara, Maki, Matsuyama 2009): graphs inside the body
instead of aligned surfaces; the surface is aligned from there. reeb-2009: the same to the paper's letter.
"""

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import linked
from kinetree.tasks.input import INPUT
from kinetree.tasks.paper_2009 import LETTER_2009, PAPER_2009, SURFACE_2009
from kinetree.tasks.paper_2014 import PAPER_2014, PAPER_2014_ALIGNED
from kinetree.tasks.registration import ALIGNED, REGISTRATION
from kinetree.tasks.registration.frame_confidence import frame_confidence
from kinetree.tasks.results.evaluation import evaluation
from kinetree.tasks.results.shelf import FIGURES, FIGURES_2009, FIGURES_2014, OVER_SEQUENCES, RESULTS
from kinetree.tasks.results.verdict import verdict
from kinetree.tasks.structure import STRUCTURE
from kinetree.tasks.structure.error_bars import unknown_error_bars
from kinetree.tasks.structure.further_pose import further_pose
from kinetree.tasks.structure.joint_names import joint_names
from kinetree.tasks.structure.pose_refinement import pose_refinement
from kinetree.tasks.structure.skeleton import skeleton
from kinetree.tasks.topology import TOPOLOGY
from kinetree.tasks.topology.up_direction import up_direction

POSES = (pose_refinement, further_pose, skeleton, unknown_error_bars, joint_names)
"""What turns a kinematic tree into the skeleton, in every method that has one."""

METHODS = {
    "mesoscopic": Graph.of((*INPUT, *TOPOLOGY, *REGISTRATION, *STRUCTURE, *FIGURES, *RESULTS)),
    "mesoscopic-2014": Graph.of(
        (*INPUT, *TOPOLOGY, *PAPER_2014, unknown_error_bars, joint_names, frame_confidence, *FIGURES_2014, *RESULTS)
    ),
    "mesoscopic-2014-aligned": Graph.of(
        (*INPUT, *TOPOLOGY, *REGISTRATION, *PAPER_2014_ALIGNED, unknown_error_bars, joint_names, *FIGURES_2014, *RESULTS)
    ),
    "reeb": Graph.of((*INPUT, *TOPOLOGY, *PAPER_2009, *SURFACE_2009, *ALIGNED, *POSES, *FIGURES_2009, *RESULTS)),
    "reeb-2009": Graph.of((*INPUT, *TOPOLOGY, *PAPER_2009, *LETTER_2009, frame_confidence, *POSES, *FIGURES_2009, *RESULTS)),
}
"""The graph of each method, checked when this module is imported."""

MADE_BY_METHODS = (skeleton, evaluation, frame_confidence, up_direction, verdict)
"""Whose artifacts, of every sequence, the summary of a data set reads; every method writes them."""
DATA_SETS = Graph.of((*(linked(task, over="sequence") for task in MADE_BY_METHODS), *OVER_SEQUENCES))
"""The graph that sums up a data set."""
