"""Laws of the choice of a reference frame."""

import numpy as np
import pytest

from kinetree.tasks.numerics.registration.reference import Reference, bending, profile, remoteness, unlikeness
from kinetree.tasks.numerics.registration.reference import reference as choose


def poses(values):
    return np.asarray(values, float)[:, None] + np.arange(5.0)


def limb(angles, length=1.0):
    """(1, frame, 3, xyz) one limb of two bones, bent at its middle."""
    bent = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))], axis=1)
    straight = np.tile([1.0, 0.0, 0.0], (len(angles), 1))
    return length * np.stack([np.zeros_like(straight), straight, straight + bent], axis=1)[None]


def reference(leaves, euler, area, bodies=None, limbs=None) -> Reference:
    """Frames that do not differ but in what is given."""
    n = len(leaves)
    bodies = np.zeros((n, 5)) if bodies is None else bodies
    return choose(leaves, euler, area, bodies, np.zeros((0, n, 3, 3)) if limbs is None else limbs)


def test_with_nothing_to_tell_frames_apart_the_middle_one_is_chosen():
    found = reference([5] * 9, [2] * 9, [1.0] * 9)
    assert (found.frame, found.free) == (4, True)


@pytest.mark.parametrize("contact", [[3, 4, 5], [2, 3, 4], [0, 4, 8]])
def test_no_frame_in_contact_or_beside_it_is_chosen_while_others_are_free(contact):
    leaves = np.full(30, 5)
    leaves[contact] = 4
    found = reference(leaves, [2] * 30, [1.0] * 30)
    assert found.free
    assert min(abs(found.frame - c) for c in contact) > 2


def test_a_frame_in_contact_is_not_chosen_for_its_pose_or_its_area():
    leaves = [4, 4, 4, 5, 5, 5, 5, 5, 5]
    found = reference(leaves, [2] * 9, [1.0] * 3 + [0.9] * 6, limbs=limb([0, 0, 0, 1, 2, 1, 2, 1, 2]))
    assert found.frame >= 5


def test_where_every_frame_touches_the_least_fused_is_chosen_and_marked():
    leaves = [5, 4, 3, 3, 4, 4, 4, 4, 4]
    found = reference(leaves, [2] * 9, [1.0] * 9)
    assert found.frame >= 6
    assert not found.free


def test_where_contact_lies_beside_every_frame_one_that_is_free_itself_is_chosen():
    leaves = [4, 5, 4, 4, 4, 4, 4, 4, 5]
    found = reference(leaves, [2] * 9, [1.0] * 9)
    assert found.frame == 1
    assert not found.free


def test_contact_beside_a_frame_says_nothing_where_the_pose_is_another():
    leaves, slow, fast = [4, 5, 4, 4, 4, 4, 4, 4, 4, 4], np.linspace(0, 1, 10), np.tile([0.0, 2.0], 5)
    assert not reference(leaves, [2] * 10, [1.0] * 10, limbs=limb(slow)).free
    found = reference(leaves, [2] * 10, [1.0] * 10, limbs=np.concatenate([limb(fast), limb(fast + np.arange(10))]))
    assert (found.frame, found.free) == (1, True)


@pytest.mark.parametrize(("angle", "counts"), [(0.01, True), (1.0, False)])
def test_contact_beside_a_frame_counts_where_the_body_hardly_moves(angle, counts):
    """Though most other pairs of frames are more alike than it and its neighbours."""
    bent = np.zeros(10)
    bent[1] = angle
    free, touching = (reference([first] + [5] * 9, [2] * 10, [1.0] * 10, limbs=limb(bent, length=0.5)) for first in (5, 4))
    assert (free.score - touching.score > 0.9).tolist() == [True, counts, True] + [False] * 7


def test_a_frame_of_another_body_is_neither_chosen_nor_the_measure_of_the_others():
    leaves, area = [5, 5, 5, 5, 8, 5, 5, 5, 5, 5, 5, 5], [1.0] * 4 + [2.0] + [1.0] * 7
    found = reference(leaves, [2] * 12, area, poses([0, 0.1, 0, 0.1, 50, 0, 0.1, 0, 0.1, 0, 0.1, 0]))
    assert found.frame >= 7
    assert found.free


def test_of_free_frames_those_amid_more_surface_are_chosen():
    area = np.array([1.05] * 3 + [1.0] * 6)
    assert reference([5] * 9, [2] * 9, area).frame == 0


def test_no_frame_beside_one_that_lacks_part_of_a_limb_is_chosen():
    area = np.where(np.isin(np.arange(30), [13, 14]), 0.97, 1.0)
    assert reference([5] * 30, [2] * 30, area).frame in (10, 17)


def test_of_equal_frames_the_pose_amid_all_others_is_chosen():
    angles = np.array([0, 1, 2, 9, 9, 9, 4, 8, 3]) / 5.0
    assert reference([5] * 9, [2] * 9, [1.0] * 9, limbs=limb(angles)).frame == 6


def test_of_equal_poses_the_frame_nearest_to_the_middle_is_chosen():
    angles = np.array([1, 1, 0, 0, 0, 2, 1, 1, 2, 2, 1, 1])
    assert reference([5] * 12, [2] * 12, [1.0] * 12, limbs=limb(angles)).frame == 6


def test_handles_count_against_a_frame_and_its_neighbours():
    euler = np.array([2, 2, 2, 2, -4, -4, -4, -4, -4])
    assert reference([5] * 9, euler, [1.0] * 9).frame == 1


def test_unit_and_direction_of_time_do_not_matter():
    rng = np.random.default_rng(0)
    leaves, euler, area, profile = rng.integers(4, 6, 20), rng.choice([0, 2], 20), rng.uniform(0.9, 1, 20), rng.random((20, 7))
    limbs = limb(rng.uniform(0, 2, 20))
    found = reference(leaves, euler, area, profile, limbs)
    assert reference(leaves, euler, 1e6 * area, profile, 1e3 * limbs).frame == found.frame
    assert reference(leaves[::-1], euler[::-1], area[::-1], profile[::-1], limbs[:, ::-1]).frame == 19 - found.frame
    np.testing.assert_allclose(remoteness(unlikeness(3 * profile)), remoteness(unlikeness(profile)))


def test_a_single_frame_is_its_own_reference():
    assert reference([3], [2], [1.0]).frame == 0


def test_frames_that_do_not_differ_are_not_remote():
    np.testing.assert_array_equal(remoteness(unlikeness(np.ones((4, 3)))), 0.0)
    np.testing.assert_array_equal(remoteness(bending(limb(np.ones(4)))), 0.0)
    np.testing.assert_array_equal(bending(np.zeros((0, 4, 3, 3))), np.zeros((4, 4)))


def test_bending_is_the_mean_change_of_straight_distances():
    # of the three distances between root, knee and tip only the last one changes, from 2 to the root of 2
    found = bending(limb([0.0, np.pi / 2]))
    np.testing.assert_allclose(found, (2 - np.sqrt(2)) / 3 * np.array([[0, 1], [1, 0]]), atol=1e-12)


def test_bending_knows_neither_place_nor_direction():
    rng = np.random.default_rng(1)
    stems, turn = rng.normal(size=(4, 6, 3, 3)), np.linalg.qr(rng.normal(size=(6, 3, 3)))[0]
    moved = np.einsum("tyx,ltsx->ltsy", turn, stems) + rng.normal(size=(1, 6, 1, 3))
    np.testing.assert_allclose(bending(moved), bending(stems), atol=1e-12)


def test_limbs_that_are_not_seen_do_not_count_and_frames_without_a_common_one_are_as_far_as_any():
    two = np.concatenate([limb([0.0, 0.5, 1.0, 1.5])] * 2)
    hidden = two.copy()
    hidden[1, 2] = np.nan
    own = bending(limb([0.0, 0.5, 1.0, 1.5]))
    np.testing.assert_allclose(bending(hidden)[2], own[2], atol=1e-12)
    hidden[0, 2] = np.nan
    assert (bending(hidden)[2] == bending(hidden).max()).all()


def test_the_profile_of_a_pose_knows_neither_scale_nor_tessellation():
    x = np.linspace(0, 1, 1001)
    fine = profile(2 + x**2, np.full(1001, 1 / 1001))
    np.testing.assert_allclose(fine, 2 + ((np.arange(100) + 0.5) / 100) ** 2, atol=0.01)
    np.testing.assert_allclose(profile(1000 * (2 + x**2), np.full(1001, 100 / 1001)), fine, rtol=1e-9)
    uneven = np.linspace(0, 1, 1001) ** 3
    np.testing.assert_allclose(profile(2 + uneven**2, np.gradient(uneven)), fine, atol=0.01)
