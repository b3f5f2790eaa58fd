"""The 2009 paper: Reeb graphs inside the body, coherent intervals, graphs deformed and clustered, one structure (Sec. 2)."""

from kinetree.tasks.paper_2009.coherent_intervals import coherent_intervals
from kinetree.tasks.paper_2009.contact_kinds import contact_kinds
from kinetree.tasks.paper_2009.graph_alignment import graph_alignment
from kinetree.tasks.paper_2009.graph_deformation import graph_deformation
from kinetree.tasks.paper_2009.graph_motion import graph_motion
from kinetree.tasks.paper_2009.graph_projection import graph_projection
from kinetree.tasks.paper_2009.graph_reference import graph_reference
from kinetree.tasks.paper_2009.graph_skeleton import graph_skeleton
from kinetree.tasks.paper_2009.graph_tracking import graph_tracking
from kinetree.tasks.paper_2009.initial_frames import initial_frames
from kinetree.tasks.paper_2009.initial_model import initial_model
from kinetree.tasks.paper_2009.integrated_structure import integrated_structure
from kinetree.tasks.paper_2009.node_clusters import node_clusters
from kinetree.tasks.paper_2009.perg import perg
from kinetree.tasks.paper_2009.reeb_graph import reeb_graph
from kinetree.tasks.paper_2009.similarity import similarity

PAPER_2009 = (
    reeb_graph,
    perg,
    similarity,
    coherent_intervals,
    initial_frames,
    initial_model,
    graph_deformation,
    node_clusters,
    integrated_structure,
    graph_motion,
    contact_kinds,
    graph_skeleton,
)
"""What both methods of 2009 have in common."""
LETTER_2009 = (graph_alignment, graph_projection)
"""The surface goes with the nodes, as the paper leaves it."""
SURFACE_2009 = (graph_reference, graph_tracking)
"""The surface is bent onto every frame by tasks of the shelf registration, from where the nodes carry it."""
