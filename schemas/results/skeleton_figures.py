"""Pictures of the body with its skeleton."""

from kinetree.schemas.results.figures import Figures


class SkeletonFigures(Figures):
    """Parts and skeleton in some frames."""
