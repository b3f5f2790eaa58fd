"""Pictures of the joints over time."""

from kinetree.schemas.results.figures import Figures


class MotionFigures(Figures):
    """The angles of joints."""
