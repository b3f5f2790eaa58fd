"""Bones of constant length are found from the motions of the parts beside them."""

import numpy as np
import pytest
from articulated import swings
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.rigid_links import (
    Between,
    RigidLinksSettings,
    likeliest_link,
    link_motion,
    rigid_link,
)

ENDS = np.array([[0.1, -0.2, 0.3], [0.6, 0.9, 1.4]])
Motion = tuple[Floats, Floats]


def linked(degrees: float = 30.0, frames: int = 40, noise: float = 0.0, scale: float = 1.0) -> tuple[Motion, Motion]:
    """Two parts in motion with a bone between them, ends and all as they are in the reference."""
    rng, turn = np.random.default_rng(5), swings(frames, 3, degrees, axes=3, seed=2)
    R, t = [turn[:, 0]], [rng.normal(0.0, scale, (frames, 3))]
    for k, end in enumerate(scale * ENDS):
        R.append(R[k] @ turn[:, k + 1])
        t.append(R[k] @ end + t[k] - R[k + 1] @ end)
    return (R[0], t[0]), (R[2], t[2] + rng.normal(0.0, noise * scale, (frames, 3)))


def between(above: Motion, below: Motion, radius: float = 1.0, noise: float = 1e-3) -> Between:
    return Between.of(above, below, radius, noise)


@pytest.mark.parametrize("scale", [1.0, 500.0])
def test_ends_follow_from_motions_alone_in_any_unit(scale: float) -> None:
    there = between(*linked(scale=scale), radius=scale, noise=1e-3 * scale)
    link = rigid_link(there, scale * (ENDS + [[0.2, 0.1, -0.2], [-0.1, 0.3, 0.1]]), spread=1.0, alike=36.0)
    np.testing.assert_allclose(link.ends, scale * ENDS, atol=0.005 * scale)
    assert link.length == pytest.approx(scale * np.linalg.norm(ENDS[1] - ENDS[0]), rel=0.005)
    assert link.deviation < 1e-3 * scale


def test_ends_stay_where_they_are_expected_if_nothing_moves() -> None:
    still = np.broadcast_to(np.eye(3), (20, 3, 3)), np.zeros((20, 3))
    expected = ENDS + 0.3
    np.testing.assert_allclose(rigid_link(between(still, still), expected, 1.0, 36.0).ends, expected, atol=1e-9)


def test_ends_stay_nearer_to_where_they_are_expected_the_noisier_the_motions() -> None:
    expected, motions = ENDS + 0.3, linked(noise=0.01)
    away = [
        np.linalg.norm(rigid_link(between(*motions, noise=n), expected, 1.0, 36.0).ends - expected) for n in (0.01, 0.3, 3.0)
    ]
    assert away[0] > 1.2 * away[1] > 1.2 * 1.2 * away[2]


def test_frames_beyond_those_that_err_alike_hold_the_ends_more_firmly() -> None:
    expected, there = ENDS + 0.3, between(*linked(noise=0.02), noise=0.5)
    firm, loose = (np.linalg.norm(rigid_link(there, expected, 1.0, alike).ends - expected) for alike in (2.0, 40.0))
    assert firm < 0.9 * loose


def test_few_frames_hold_the_ends_no_less_firmly_than_as_many_as_err_alike() -> None:
    expected, there = ENDS + 0.3, between(*linked(frames=8, noise=0.02), noise=0.5)
    few, as_many = (rigid_link(there, expected, 1.0, alike).ends for alike in (1000.0, 8.0))
    np.testing.assert_allclose(few, as_many)


def test_of_one_joint_both_ends_are_found_though_the_search_begins_at_neither() -> None:
    link = likeliest_link(between(*linked()), ENDS.mean(axis=0), RigidLinksSettings())
    np.testing.assert_allclose(link.ends, ENDS, atol=0.02)


def test_the_bone_lies_where_the_parts_carry_its_ends() -> None:
    above, below = linked()
    R, t = link_motion(above, below, ENDS, swings(40, 1, 50.0, seed=9)[:, 0])
    np.testing.assert_allclose(R @ R.transpose(0, 2, 1), np.broadcast_to(np.eye(3), R.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(R), 1.0)
    for (R_k, t_k), end in zip((above, below), ENDS, strict=True):
        np.testing.assert_allclose(R @ end + t, R_k @ end + t_k, atol=1e-9)


def test_the_bone_turns_about_itself_as_it_was_told() -> None:
    above, below = linked()
    along, true = (ENDS[1] - ENDS[0]) / np.linalg.norm(ENDS[1] - ENDS[0]), swings(40, 3, 30.0, axes=3, seed=2)
    true_R = true[:, 0] @ true[:, 1]
    aside = Rotation.from_rotvec(0.3 * np.cross(along, [1.0, 0.0, 0.0])).as_matrix()
    twisted = Rotation.from_rotvec(0.4 * along).as_matrix()
    R, _ = link_motion(above, below, ENDS, true_R @ twisted)
    np.testing.assert_allclose(R, true_R @ twisted, atol=1e-9)
    R, _ = link_motion(above, below, ENDS, aside @ true_R)
    np.testing.assert_allclose(R @ along, true_R @ along, atol=1e-9)
