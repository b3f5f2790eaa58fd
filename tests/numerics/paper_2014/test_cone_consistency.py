"""Laws of cones across intervals, on a strip of forty vertices whose cones are stretches of it."""

import numpy as np

from kinetree.tasks.numerics.paper_2014.cone_consistency import Cut, Seen, carry, limbs, shared

COUNT = 40
SAME = np.arange(COUNT)


def stretch(begin, end):
    ring = np.full(COUNT, -1)
    ring[begin:end] = np.arange(end - begin) // 2
    return ring


def seen(*cones, span=None):
    ring = np.array([stretch(*c) for c in cones]).reshape(-1, COUNT)
    return Seen(ring, np.ones(COUNT), np.array(span or [1.0] * len(ring)))


def cut(*pairs):
    columns = np.array(pairs, float).reshape(-1, 3).T
    return Cut(SAME, SAME, columns[0].astype(int), columns[1].astype(int), columns[2])


A, B, C = (0, 12), (14, 26), (28, 40)


def test_matched_leaves_are_one_limb_whatever_their_numbers():
    found = limbs([seen(A, B), seen(B, A)], [cut((0, 1, 0.1), (1, 0, 0.1))], 1.0)
    assert found.leaf.tolist() == [[0, 1], [1, 0]]
    assert (found.ring[1][0] == stretch(*A)).all()


def test_cone_that_is_lost_is_recovered_where_it_was_mapped():
    found = limbs([seen(A, B), seen(B)], [cut((1, 0, 0.1))], 1.0)
    assert found.leaf.tolist() == [[0, 1], [-1, 0]]
    assert (found.ring[1][0] == stretch(*A)).all()


def test_cone_that_appears_later_is_recovered_in_the_intervals_before():
    found = limbs([seen(A), seen(A, C)], [cut((0, 0, 0.1))], 1.0)
    assert found.leaf.tolist() == [[0, -1], [0, 1]]
    assert (found.ring[0][1] == stretch(*C)).all()


def test_cone_that_comes_back_is_the_limb_that_was_lost():
    every = [seen(A, B), seen(B), seen(B, A)]
    found = limbs(every, [cut((1, 0, 0.1)), cut((0, 0, 0.1))], 1.0)
    assert found.leaf.tolist() == [[0, 1], [-1, 0], [1, 0]]


def test_of_leaves_too_far_apart_that_with_fewer_annuli_is_erroneous():
    elbow = (6, 12)
    found = limbs([seen(A, B), seen(elbow, B)], [cut((0, 0, 5.0), (1, 1, 0.1))], 1.0)
    assert found.leaf.tolist() == [[0, 1], [-1, 1]]
    assert (found.ring[1][0] == stretch(*A)).all(), "the whole arm is recovered in its place"
    back = limbs([seen(elbow, B), seen(A, B)], [cut((0, 0, 5.0), (1, 1, 0.1))], 1.0)
    assert back.leaf.tolist() == [[1, -1], [1, 0]]


def test_equally_many_annuli_are_decided_by_the_range_of_mu():
    found = limbs([seen(A, span=[1.0]), seen(A, span=[2.0])], [cut((0, 0, 5.0))], 1.0)
    assert found.leaf.tolist() == [[-1], [0]]


def test_elbow_without_a_partner_inside_a_lost_arm_is_erroneous():
    found = limbs([seen(A, B), seen((6, 12), B)], [cut((1, 1, 0.1))], 1.0)
    assert found.leaf.tolist() == [[0, 1], [-1, 1]]


def test_vertices_that_map_nowhere_are_in_no_cone():
    source = SAME.copy()
    source[3] = -1
    ring = carry(stretch(*A), source)
    assert ring[3] == -1
    assert (np.delete(ring, 3) == np.delete(stretch(*A), 3)).all()


def test_share_is_of_the_smaller_cone():
    assert shared(stretch(0, 20), stretch(10, 14), np.ones(COUNT)) == 1.0
    assert shared(stretch(0, 20), stretch(18, 22), np.ones(COUNT)) == 0.5
    assert shared(stretch(0, 20), stretch(0, 0), np.ones(COUNT)) == 0.0


def test_no_leaf_no_limb():
    found = limbs([seen(), seen()], [cut()], 1.0)
    assert found.leaf.shape == (2, 0)
    assert found.ring[0].shape == (0, COUNT)
