"""Laws of the order in which frames are reached."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinetree.tasks.numerics.registration.tracking_order import takes_order, tracking_order


def test_all_frames_learned_from_are_reached_from_their_neighbours() -> None:
    assert tracking_order(np.ones(5, bool), 2).tolist() == [1, 2, -1, 2, 3]


@given(st.lists(st.booleans(), min_size=1, max_size=12), st.data())
def test_every_frame_leads_to_the_reference_and_no_learned_one_through_a_further_one(
    flags: list[bool], data: st.DataObject
) -> None:
    reference = data.draw(st.integers(0, len(flags) - 1))
    learned = np.array(flags)
    learned[reference] = True
    before = tracking_order(learned, reference)
    for t in range(len(flags)):
        way, at = [], t
        while before[at] >= 0:
            assert abs(before[at] - reference) < abs(at - reference)
            at = int(before[at])
            way.append(at)
        assert at == reference
        assert not learned[t] or learned[way].all()


def test_the_order_of_learned_frames_is_that_without_the_others() -> None:
    learned = np.array([1, 0, 1, 1, 0, 0, 1, 1, 0], bool)
    number = np.flatnonzero(learned)
    alone = tracking_order(np.ones(len(number), bool), 2)
    among = tracking_order(learned, int(number[2]))[learned]
    assert among.tolist() == [int(number[b]) if b >= 0 else -1 for b in alone]


def test_every_take_is_reached_by_its_entry_and_from_there_outwards() -> None:
    takes = [slice(0, 3), slice(3, 6), slice(6, 8)]
    before = takes_order(np.ones(8, bool), takes, {1: -1, 5: 0, 6: 3})
    assert before.tolist() == [1, -1, 1, 4, 5, 0, 3, 6]
