"""Pictures of how the body was cut into rigid parts."""

from kinetree.schemas.results.figures import Figures


class CutFigures(Figures):
    """Cones and elimination."""
