"""Pictures of the joints over time."""

from kinetree.schemas.results.figures import Figures


class MotionFigures(Figures):
    """The tree of joints, their confidence and their angles."""
