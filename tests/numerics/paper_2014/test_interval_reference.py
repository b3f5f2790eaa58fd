"""Laws of the choice of an interval's reference."""

import numpy as np

from kinetree.tasks.numerics.paper_2014.interval_reference import middle_frame


def test_middle_is_the_middle_unless_leaves_are_hidden_there():
    assert [middle_frame(np.ones((3, n), bool)) for n in (1, 2, 3, 12)] == [0, 0, 1, 5]
    is_seen = np.ones((3, 9), bool)
    is_seen[1, 3:6] = False
    assert middle_frame(is_seen) == 2
    assert middle_frame(np.zeros((0, 5), bool)) == 2
