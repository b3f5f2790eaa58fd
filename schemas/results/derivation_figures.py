"""Pictures of how joints were found that need no names of joints."""

from kinetree.schemas.results.figures import Figures


class DerivationFigures(Figures):
    """Cones, elimination, and the graph of parts."""
