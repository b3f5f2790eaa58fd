"""What became of sequences opens the dimension of those that have a result."""

from results.sequence_tables import DANCE, TORN, WALK

from kinetree.schemas.results.outcomes import OutcomesParams
from kinetree.tasks.results.outcomes import outcomes


def test_sequences_with_a_result_are_the_members():
    listed = outcomes(params=OutcomesParams(sequences=(DANCE, TORN, WALK)), files=None)
    assert listed.sequences == (DANCE, TORN, WALK)
    assert listed.members("sequence", ()) == (0, 2)
