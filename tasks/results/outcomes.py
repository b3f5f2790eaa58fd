"""What became of the sequences of a data set, as its run tells."""

from kinetree.pipeline.task import origin
from kinetree.schemas.results.outcomes import Outcomes, OutcomesParams


@origin()
def outcomes(params: OutcomesParams, files: object) -> Outcomes:
    """Takes over what became of every sequence (ours)."""
    return Outcomes(sequences=params.sequences)
