"""Pictures of the joints and how far they are to be believed."""

from kinetree.schemas.results.figures import Figures


class TreeFigures(Figures):
    """The tree of joints and their confidence."""
