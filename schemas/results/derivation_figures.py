"""Pictures of how joints were found that need no names of joints."""

from kinetree.schemas.results.figures import Figures


class DerivationFigures(Figures):
    """The graph of parts."""
