"""Laws of sections of limbs, on a tube that is bent at a known place."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.limb_sections import section_middle, share_beyond, way_along

RADIUS, LENGTH, AROUND, ALONG = 0.5, 6.0, 16, 60


def tube(bend):
    """A tube whose middle is a hinge at the origin: to −z on one side, turned by `bend` degrees about x on the other."""
    V = []
    for k in range(ALONG + 1):
        along = LENGTH * (2.0 * k / ALONG - 1.0)
        turn = np.radians(bend) * (along > 0.0)
        half = np.radians(bend) / 2.0 if along == 0.0 else turn
        forward = np.array([0.0, -np.sin(turn), np.cos(turn)])
        side = np.array([0.0, np.cos(half), np.sin(half)])
        for angle in 2.0 * np.pi * np.arange(AROUND) / AROUND:
            V.append(along * forward + RADIUS * (np.cos(angle) * np.array([1.0, 0, 0]) + np.sin(angle) * side))
    k, a = (x.ravel() for x in np.meshgrid(np.arange(ALONG), np.arange(AROUND), indexing="ij"))
    b = (a + 1) % AROUND
    lower, upper = np.stack([k * AROUND + a, k * AROUND + b]), np.stack([(k + 1) * AROUND + a, (k + 1) * AROUND + b])
    F = np.concatenate([np.stack([lower[0], lower[1], upper[1]], 1), np.stack([lower[0], upper[1], upper[0]], 1)])
    end = LENGTH * np.array([0.0, -np.sin(np.radians(bend)), np.cos(np.radians(bend))])
    return np.array(V), F, np.array([[0.0, 0, -LENGTH - 1], [0, 0, -LENGTH], end])


PARENTS = [-1, 0, 1]


@pytest.mark.parametrize("bend", [0, 40, 90])
def test_middle_of_a_bent_tube_is_its_hinge(bend):
    V, F, rest = tube(bend)
    way = way_along(V, F, np.ones(len(V), int), PARENTS, rest, 2)
    assert 0.0 <= way.min() < 0.1
    assert 0.9 < way.max() <= 1.0
    assert np.linalg.norm(section_middle(V, F, way, 0.5)) < 0.5 * RADIUS
    quarter = section_middle(V, F, way, 0.25)
    np.testing.assert_allclose(quarter, [0, 0, -LENGTH / 2], atol=0.5 * RADIUS)


def test_ways_do_not_depend_on_where_the_tube_lies_or_on_its_unit():
    V, F, rest = tube(60)
    Q = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    part = np.ones(len(V), int)
    way = way_along(V, F, part, PARENTS, rest, 2)
    np.testing.assert_allclose(way_along(7 * V @ Q.T + 3, F, part, PARENTS, 7 * rest @ Q.T + 3, 2), way, atol=1e-9)


def test_other_parts_have_no_way_and_thin_bones_no_section():
    V, F, rest = tube(0)
    part = np.where(V[:, 2] < -LENGTH / 2, 0, np.where(V[:, 2] > LENGTH / 2, 2, 1))
    way = way_along(V, F, part, PARENTS, rest, 2)
    np.testing.assert_array_equal(np.isnan(way), part != 1)
    assert section_middle(V, F, way_along(V, F, np.zeros(len(V), int), PARENTS, rest, 2), 0.5) is None


@pytest.mark.parametrize("bend", [0, 40, 90])
def test_what_lies_beyond_a_hinge_is_one_half_of_the_tube(bend):
    V, F, rest = tube(bend)
    beyond = share_beyond(V, F, np.zeros(3), rest[1], rest[2])
    row = np.repeat(np.arange(ALONG + 1), AROUND) - ALONG // 2
    np.testing.assert_allclose(beyond[row == 0], 0.5, atol=1e-6)
    assert (beyond[row > ALONG // 8] == 1.0).all()
    assert (beyond[row < -ALONG // 8] == 0.0).all()
    assert ((beyond >= 0.0) & (beyond <= 1.0)).all()


def test_a_piece_that_only_lies_beyond_the_plane_does_not_follow():
    V, F, rest = tube(0)
    beside = V + [10.0, 0, 0]
    beyond = share_beyond(np.concatenate([V, beside]), np.concatenate([F, F + len(V)]), np.zeros(3), rest[1], rest[2])
    assert beyond[: len(V)].max() == 1.0
    assert beyond[len(V) :].max() == 0.0
