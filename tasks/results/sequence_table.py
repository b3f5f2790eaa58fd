"""All sequences of a data set in one table."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.results.outcomes import Outcomes
from kinetree.schemas.results.sequence_figures import SequenceFigures
from kinetree.schemas.results.sequence_table import SequenceRow, SequenceTable
from kinetree.tasks.numerics.results.thumbnail import SIDE


@task()
def sequence_table(outcomes: Outcomes, sequence_figures: Mapping[int, SequenceFigures]) -> SequenceTable:
    """Gathers what became of every sequence and its figures (ours)."""
    place = {member: number for number, member in enumerate(sequence_figures)}
    rows = [SequenceRow(outcome=outcome) for outcome in outcomes.sequences]
    for member, figures in sequence_figures.items():
        known = figures.plain()
        rows[member] = SequenceRow(outcome=outcomes.sequences[member], picture=place[member], **known)
    pictures = [np.asarray(figures.picture) for figures in sequence_figures.values()]
    return SequenceTable(rows=tuple(rows), pictures=np.array(pictures, np.uint8).reshape(-1, SIDE, SIDE, 3))
