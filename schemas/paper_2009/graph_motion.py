"""The integrated structure in one frame, coherent or not (2009, Sec. 2.5)."""

from kinetree.schemas.paper_2009.graph_deformation import GraphDeformation, GraphDeformationParams


class GraphMotionParams(GraphDeformationParams):
    """As for `graph_deformation`; only for frames that are in no interval of the integrated structure's own model."""


class GraphMotion(GraphDeformation):
    """Where the integrated structure is."""

    fitted_here: bool
    """Whether it was fitted for this description; False where the frame's own piecewise structure is the integrated one."""
