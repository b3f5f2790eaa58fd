"""Laws of cones across intervals, on a strip of forty vertices whose cones are stretches of it."""

import numpy as np

from kinetree.tasks.numerics.paper_2014.cone_consistency import (
    ConeConsistencySettings,
    Cut,
    IntervalCones,
    consistent_cones,
    overlap,
    transferred_annuli,
)

COUNT = 40
EVERY = np.arange(COUNT)


def stretch(begin, end):
    annulus = np.full(COUNT, -1)
    annulus[begin:end] = np.arange(end - begin) // 2
    return annulus


def interval(*cones, mu_range=None):
    annulus = np.array([stretch(*c) for c in cones]).reshape(-1, COUNT)
    return IntervalCones(annulus, np.ones(COUNT), np.array(mu_range or [1.0] * len(annulus)))


def cut(*pairs):
    columns = np.array(pairs, float).reshape(-1, 3).T
    return Cut(EVERY, EVERY, columns[0].astype(int), columns[1].astype(int), columns[2])


A, B, C = (0, 12), (14, 26), (28, 40)


def test_matched_leaves_are_one_cone_whatever_their_numbers():
    cones = consistent_cones([interval(A, B), interval(B, A)], [cut((0, 1, 0.1), (1, 0, 0.1))], 1.0)
    assert cones.leaf.tolist() == [[0, 1], [1, 0]]
    assert (cones.annulus[1][0] == stretch(*A)).all()


def test_cone_that_is_lost_is_recovered_where_it_was_mapped():
    cones = consistent_cones([interval(A, B), interval(B)], [cut((1, 0, 0.1))], 1.0)
    assert cones.leaf.tolist() == [[0, 1], [-1, 0]]
    assert (cones.annulus[1][0] == stretch(*A)).all()


def test_cone_that_appears_later_is_recovered_in_the_intervals_before():
    cones = consistent_cones([interval(A), interval(A, C)], [cut((0, 0, 0.1))], 1.0)
    assert cones.leaf.tolist() == [[0, -1], [0, 1]]
    assert (cones.annulus[0][1] == stretch(*C)).all()


def test_cone_that_comes_back_is_the_cone_that_was_lost():
    every = [interval(A, B), interval(B), interval(B, A)]
    cones = consistent_cones(every, [cut((1, 0, 0.1)), cut((0, 0, 0.1))], 1.0)
    assert cones.leaf.tolist() == [[0, 1], [-1, 0], [1, 0]]


def test_of_leaves_too_far_apart_that_with_fewer_annuli_is_erroneous():
    elbow = (6, 12)
    cones = consistent_cones([interval(A, B), interval(elbow, B)], [cut((0, 0, 5.0), (1, 1, 0.1))], 1.0)
    assert cones.leaf.tolist() == [[0, 1], [-1, 1]]
    assert (cones.annulus[1][0] == stretch(*A)).all(), "the whole arm is recovered in its place"
    back = consistent_cones([interval(elbow, B), interval(A, B)], [cut((0, 0, 5.0), (1, 1, 0.1))], 1.0)
    assert back.leaf.tolist() == [[1, -1], [1, 0]]


def test_equally_many_annuli_are_decided_by_the_range_of_mu():
    cones = consistent_cones([interval(A, mu_range=[1.0]), interval(A, mu_range=[2.0])], [cut((0, 0, 5.0))], 1.0)
    assert cones.leaf.tolist() == [[-1], [0]]


def test_elbow_without_a_partner_inside_a_lost_arm_is_erroneous():
    cones = consistent_cones([interval(A, B), interval((6, 12), B)], [cut((1, 1, 0.1))], 1.0)
    assert cones.leaf.tolist() == [[0, 1], [-1, 1]]


def test_vertices_without_an_image_are_in_no_cone():
    source = EVERY.copy()
    source[3] = -1
    annulus = transferred_annuli(stretch(*A), source)
    assert annulus[3] == -1
    assert (np.delete(annulus, 3) == np.delete(stretch(*A), 3)).all()


def test_overlap_is_a_share_of_the_smaller_cone():
    assert overlap(stretch(0, 20), stretch(10, 14), np.ones(COUNT)) == 1.0
    assert overlap(stretch(0, 20), stretch(18, 22), np.ones(COUNT)) == 0.5
    assert overlap(stretch(0, 20), stretch(0, 0), np.ones(COUNT)) == 0.0


def test_no_leaf_no_cone():
    cones = consistent_cones([interval(), interval()], [cut()], 1.0)
    assert cones.leaf.shape == (2, 0)
    assert cones.annulus[0].shape == (0, COUNT)


def test_two_cones_without_a_match_are_one_if_they_overlap_by_the_share_in_the_settings():
    every = [interval(A), interval((4, 16))]  # two thirds in common
    for least, leaf in ((0.6, [[0], [-1]]), (0.7, [[0, -1], [-1, 0]])):
        cones = consistent_cones(every, [cut()], 1.0, ConeConsistencySettings(least_overlap=least))
        assert cones.leaf.tolist() == leaf
