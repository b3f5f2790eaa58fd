"""Pictures of topology over time."""

from kinetree.schemas.results.figures import Figures


class TopologyFigures(Figures):
    """The correlation with the intervals, and μ on the surface."""
