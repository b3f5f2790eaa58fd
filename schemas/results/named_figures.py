"""Pictures of how joints were found that show the names of joints."""

from kinetree.schemas.results.figures import Figures


class NamedFigures(Figures):
    """Merge errors along cones, and lengths of bones."""
