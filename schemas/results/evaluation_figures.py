"""Pictures of the comparison with the truth."""

from kinetree.schemas.results.figures import Figures


class EvaluationFigures(Figures):
    """Error of every joint over time; no picture where there is no truth."""
