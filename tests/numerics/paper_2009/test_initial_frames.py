"""Laws of the initial frame and of the order in which frames are reached."""

import numpy as np

from kinetree.tasks.numerics.paper_2009.initial_frames import extended_frame, initial_frame, most_open_frames, reached_from

S = np.array([[1.0, 0.9, 0.2, 0.8], [0.9, 1.0, 0.3, 0.7], [0.2, 0.3, 1.0, 0.1], [0.8, 0.7, 0.1, 1.0]])


def test_initial_frame_has_the_greatest_sum_among_candidates() -> None:
    assert initial_frame(S, np.ones(4, bool)) in (0, 1)
    assert initial_frame(S, np.array([False, False, True, True])) in (2, 3)
    assert initial_frame(S, np.array([True, False, True, True])) == 0


def test_neighbours_lead_outwards() -> None:
    assert reached_from(S, 1, by_correlation=False).tolist() == [1, -1, 1, 2]


def test_most_similar_frame_that_was_reached_before_leads() -> None:
    assert reached_from(S, 1, by_correlation=True).tolist() == [1, -1, 1, 0]


def test_most_open_frames_have_most_ends_and_then_fewest_loops() -> None:
    assert most_open_frames(np.array([4, 5, 5, 5]), np.array([0, 2, 1, 1])).tolist() == [False, False, True, True]


def test_extended_frame_is_the_candidate_whose_ends_are_farthest_apart() -> None:
    spread, length = np.array([1.0, 2.0, 9.0, 3.0]), np.ones(4)
    assert extended_frame(np.ones(4, bool), spread, length) == 2
    assert extended_frame(np.array([True, True, False, True]), spread, length) == 3


def test_extended_frame_is_none_in_which_limbs_are_fused() -> None:
    spread, length = np.array([1.0, 2.0, 9.0, 3.0]), np.array([1.0, 0.95, 0.6, 0.5])
    assert extended_frame(np.ones(4, bool), spread, length) == 1
    assert extended_frame(np.array([False, False, True, True]), spread, length) == 2
