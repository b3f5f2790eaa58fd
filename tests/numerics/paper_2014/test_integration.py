"""Laws of labels shared by intervals."""

import numpy as np

from kinetree.tasks.numerics.paper_2014.integration import integrated, most_clusters, rigid_areas


def marks(text):
    return np.array([c == "#" for c in text], bool)


def test_annulus_is_a_joint_everywhere_if_it_is_one_anywhere():
    one, other = marks("##.###"), marks("####.#")
    assert (integrated([np.arange(6)] * 2, [one, other], 8) == marks("##.#.###")).all()


def test_annulus_that_an_interval_lacks_says_nothing():
    assert (integrated([np.array([0, 1, 4])], [marks("#.#")], 5) == marks("#.###")).all()


def test_rigid_areas_are_runs():
    assert [rigid_areas(marks(t)) for t in ("", "#", ".", "##.#..##", ".#.#.")] == [0, 1, 0, 3, 2]


def test_threshold_is_the_lowest_of_those_with_the_most_clusters():
    assert most_clusters(np.array([1, 4, 4, 4, 2, 4])) == 1
    assert most_clusters(np.array([3])) == 0
