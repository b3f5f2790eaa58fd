"""The papers' table of contents: every operation, in the order in which the papers tell it.

MESOSCOPIC: Tree-structured mesoscopic surface characterization (Mukasa, Nobuhara, Tung, Matsuyama 2014), the default, with
what was measured to be better in place of some of its steps. MESOSCOPIC_2014: the same to the paper's letter. Both begin
with MACROSCOPIC.
"""

from kinetree.pipeline.graph import Graph
from kinetree.tasks.alignment import alignment
from kinetree.tasks.annuli import annuli
from kinetree.tasks.arap import arap
from kinetree.tasks.articulation import articulation
from kinetree.tasks.bones import bones
from kinetree.tasks.bvh import bvh
from kinetree.tasks.cones import cones
from kinetree.tasks.connectivity import connectivity
from kinetree.tasks.consistency import consistency
from kinetree.tasks.coordinates import coordinates
from kinetree.tasks.correlation import correlation
from kinetree.tasks.crossing import crossing
from kinetree.tasks.cylinders import cylinders
from kinetree.tasks.distribution import distribution
from kinetree.tasks.evaluation import evaluation
from kinetree.tasks.evidence import evidence
from kinetree.tasks.fit import fit
from kinetree.tasks.geodesics import geodesics
from kinetree.tasks.glb import glb
from kinetree.tasks.integration import integration
from kinetree.tasks.intervals import intervals
from kinetree.tasks.kinematic_structure import kinematic_structure
from kinetree.tasks.landed_alignment import landed_alignment
from kinetree.tasks.landed_projection import landed_projection
from kinetree.tasks.landing import landing
from kinetree.tasks.leaves import leaves
from kinetree.tasks.letter_evidence import letter_evidence
from kinetree.tasks.limb import limb
from kinetree.tasks.matching import matching
from kinetree.tasks.mesh import mesh
from kinetree.tasks.middle import middle
from kinetree.tasks.parts import parts
from kinetree.tasks.pieces import pieces
from kinetree.tasks.ply import ply
from kinetree.tasks.projection import projection
from kinetree.tasks.reference import reference
from kinetree.tasks.refit import first_refit, second_refit, third_refit
from kinetree.tasks.repair import repair
from kinetree.tasks.report import report
from kinetree.tasks.rignet import rignet
from kinetree.tasks.segmentation import segmentation
from kinetree.tasks.sequence import sequence
from kinetree.tasks.skeleton import skeleton
from kinetree.tasks.skeleton_json import skeleton_json
from kinetree.tasks.source import source
from kinetree.tasks.stiffness import first_stiffness, second_stiffness, third_stiffness
from kinetree.tasks.suspects import suspects
from kinetree.tasks.tables import tables
from kinetree.tasks.template import template
from kinetree.tasks.tips import tips
from kinetree.tasks.traces import traces
from kinetree.tasks.tracking import tracking
from kinetree.tasks.trust import trust
from kinetree.tasks.truth import truth
from kinetree.tasks.turns import turns
from kinetree.tasks.twist import twist
from kinetree.tasks.untwisting import untwisting
from kinetree.tasks.upright import upright
from kinetree.tasks.usd import usd

MACROSCOPIC = (
    source,  # Sec. 3
    sequence,
    mesh,
    connectivity,  # Sec. 7
    geodesics,  # Sec. 4, Eq. 1
    distribution,
    correlation,  # Eq. 2
    tips,  # Sec. 5.1
    intervals,  # Sec. 4
    leaves,  # Sec. 5.1, Eq. 3
    upright,
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
    template,  # for Sec. 5.2
    tracking,
    suspects,
    repair,
    first_stiffness,
    first_refit,
    pieces,
    turns,
    twist,
    untwisting,
    second_stiffness,
    second_refit,
    third_stiffness,
    third_refit,
    alignment,  # Sec. 5.3
    projection,
    trust,
    parts,  # Sec. 6.1 and 6.2
    articulation,  # Sec. 6.3
    fit,  # for Sec. 7.3
    skeleton,
    traces,
    *RESULTS,
    evidence,  # Figs. 7, 11 and 15
    report,
)

MESOSCOPIC_2014 = (
    *MACROSCOPIC,
    coordinates,  # Sec. 5.2, Eq. 4
    middle,  # Sec. 5.3
    matching,  # Eqs. 5 and 6
    arap,
    crossing,  # for Sec. 6.1.1
    cones,  # Sec. 6.1.1.1
    consistency,  # Sec. 6.1.1.2 to 6.1.1.4, Eqs. 7 and 8
    limb,
    annuli,  # Sec. 6.1.2, Eqs. 9 to 12
    integration,  # Sec. 6.1.3
    cylinders,  # Sec. 6.2
    bones,  # Sec. 6.3
    kinematic_structure,
    landing,
    landed_alignment,
    landed_projection,
    *RESULTS,
    letter_evidence,  # Figs. 7, 11, 13 and 15
    report,
)

METHODS = {"mesoscopic": Graph.of(MESOSCOPIC), "mesoscopic-2014": Graph.of(MESOSCOPIC_2014)}
"""The graph of each method, the default first; checked when this module is imported."""
