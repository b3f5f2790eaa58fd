"""Laws of the choice of a reference frame."""

import numpy as np
import pytest

from kinetree.tasks.numerics.reference import profile, reference, remoteness

SAME = np.zeros((9, 5))


def poses(values):
    return np.asarray(values, float)[:, None] + np.arange(5.0)


def test_with_nothing_to_tell_frames_apart_the_middle_one_is_chosen():
    found = reference([5] * 9, [2] * 9, [1.0] * 9, SAME)
    assert (found.frame, found.free) == (4, True)


@pytest.mark.parametrize("contact", [[3, 4, 5], [2, 3, 4], [0, 4, 8]])
def test_no_frame_in_contact_or_beside_it_is_chosen_while_others_are_free(contact):
    leaves = np.full(30, 5)
    leaves[contact] = 4
    found = reference(leaves, [2] * 30, [1.0] * 30, np.zeros((30, 5)))
    assert found.free
    assert min(abs(found.frame - c) for c in contact) > 2


def test_a_frame_in_contact_is_not_chosen_for_its_pose_or_its_area():
    leaves = [4, 4, 4, 5, 5, 5, 5, 5, 5]
    found = reference(leaves, [2] * 9, [1.0] * 3 + [0.9] * 6, poses([0, 0, 0, 9, 9, 9, 9, 9, 9]))
    assert found.frame >= 5


def test_where_every_frame_touches_the_least_fused_is_chosen_and_marked():
    leaves = [5, 4, 3, 3, 4, 4, 4, 4, 4]
    found = reference(leaves, [2] * 9, [1.0] * 9, SAME)
    assert found.frame >= 6
    assert not found.free


def test_a_frame_of_another_body_is_neither_chosen_nor_the_measure_of_the_others():
    leaves, area = [5, 5, 5, 5, 8, 5, 5, 5, 5, 5, 5, 5], [1.0] * 4 + [2.0] + [1.0] * 7
    found = reference(leaves, [2] * 12, area, poses([0, 0.1, 0, 0.1, 50, 0, 0.1, 0, 0.1, 0, 0.1, 0]))
    assert found.frame >= 7
    assert found.free


def test_of_free_frames_the_one_with_more_surface_is_chosen():
    area = np.ones(9)
    area[6] = 1.05
    assert reference([5] * 9, [2] * 9, area, SAME).frame == 6


def test_of_equal_frames_the_pose_amid_all_others_is_chosen():
    assert reference([5] * 9, [2] * 9, [1.0] * 9, poses([0, 1, 2, 9, 9, 9, 4, 8, 3])).frame == 6


def test_handles_count_against_a_frame_and_its_neighbours():
    euler = np.array([2, 2, 2, 2, 0, 0, 0, 0, 0])
    assert reference([5] * 9, euler, [1.0] * 9, SAME).frame == 1


def test_unit_and_direction_of_time_do_not_matter():
    rng = np.random.default_rng(0)
    leaves, euler, area, profile = rng.integers(4, 6, 20), rng.choice([0, 2], 20), rng.uniform(0.9, 1, 20), rng.random((20, 7))
    found = reference(leaves, euler, area, profile)
    assert reference(leaves, euler, 1e6 * area, profile).frame == found.frame
    assert reference(leaves[::-1], euler[::-1], area[::-1], profile[::-1]).frame == 19 - found.frame
    np.testing.assert_allclose(remoteness(3 * profile), remoteness(profile))


def test_a_single_frame_is_its_own_reference():
    assert reference([3], [2], [1.0], np.zeros((1, 5))).frame == 0


def test_frames_that_do_not_differ_are_not_remote():
    np.testing.assert_array_equal(remoteness(np.ones((4, 3))), 0.0)


def test_the_profile_of_a_pose_knows_neither_scale_nor_tessellation():
    x = np.linspace(0, 1, 1001)
    fine = profile(2 + x**2, np.full(1001, 1 / 1001))
    np.testing.assert_allclose(fine, 2 + ((np.arange(100) + 0.5) / 100) ** 2, atol=0.01)
    np.testing.assert_allclose(profile(1000 * (2 + x**2), np.full(1001, 100 / 1001)), fine, rtol=1e-9)
    uneven = np.linspace(0, 1, 1001) ** 3
    np.testing.assert_allclose(profile(2 + uneven**2, np.gradient(uneven)), fine, atol=0.01)
