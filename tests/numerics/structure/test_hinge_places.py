"""Border and joint go together to where the frames' surfaces bend the limb, if halves of the frames agree on the place."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from smeared import END, Frames, three_parts, turning

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure import hinge_places
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.hinge_costs import hinge_costs
from kinetree.tasks.numerics.structure.hinge_places import (
    HingeCosts,
    HingePlacesSettings,
    hinge_offsets,
    hinge_shifts,
    hinge_ways,
    limb_axis,
)

FRAMES = 16
"""Frames of the tube."""
ALL = np.ones((FRAMES, 3))
"""Every part is seen in every frame."""


def costs_of(off: float, scale: float = 1.0, noise: float = 0.02) -> tuple[FirstTree, HingeCosts]:
    """A tube whose last part was cut off so far beyond its joint, in radii of the tube, which bends elsewhere in the frames."""
    surface, found = three_parts(FRAMES, scale)
    tree = in_tree_order(found, 3)
    rest, label = tree.rest.copy(), tree.label.copy()
    rest[1], rest[2] = 0.0, scale * np.array([0.0, 0.0, END + off])
    label[(label > 0) & (surface.V[:, 2] > rest[2, 2])] = 2
    label[(label == 2) & (surface.V[:, 2] <= rest[2, 2])] = 1
    W = np.eye(3)[label]
    tree = tree._replace(rest=rest, label=label, W=W)
    meshes = Frames(turning()[:FRAMES], noise, scale)
    surfaces = {f: Target.of(*meshes(f), surface.size) for f in range(FRAMES)}
    return tree, hinge_costs(surface.V, surface.F, surface.area, tree, surfaces)


def shift_of(tree: FirstTree, costs: HingeCosts, certain: Floats = ALL) -> Floats:
    """(xyz,) way of the last joint."""
    return np.asarray(hinge_shifts(tree, costs, tree.rest, certain)[2])


def least_at(costs: HingeCosts, place: float, gain: float) -> HingeCosts:
    """In all frames the costs of a parabola that is least at a place, in radii, and there less than at the joint by a share."""
    row = 1.0 - gain + gain * (HingePlacesSettings().places / place - 1.0) ** 2
    return costs._replace(square=np.broadcast_to(row, costs.square.shape))


@pytest.mark.parametrize("off", [0.6, -0.6])
def test_a_joint_whose_border_was_cut_beside_the_bend_goes_to_the_bend(off: float) -> None:
    way = shift_of(*costs_of(off))
    np.testing.assert_allclose(way, [0.0, 0.0, -off], atol=0.15)


def test_the_same_on_a_body_of_another_size() -> None:
    one, two = shift_of(*costs_of(0.6)), shift_of(*costs_of(0.6, scale=40.0))
    np.testing.assert_allclose(40.0 * one, two, atol=1.0)


def test_a_joint_that_lies_right_hardly_moves() -> None:
    assert np.linalg.norm(shift_of(*costs_of(0.0))) < 0.1


def test_the_way_is_counted_from_where_other_cuts_put_the_joint() -> None:
    tree, costs = costs_of(0.6)
    rest = tree.rest.copy()
    rest[2, 2] -= 0.2
    way = hinge_shifts(tree, costs, rest, ALL)[2]
    np.testing.assert_allclose(rest[2] + way, tree.rest[2] + shift_of(tree, costs), atol=1e-9)


@pytest.mark.parametrize("period", [1, 4], ids=["each second frame", "each second quarter"])
def test_a_joint_stays_where_halves_of_the_frames_bend_the_limb_at_different_places(period: int) -> None:
    tree, costs = costs_of(0.6)
    other = np.arange(FRAMES) // period % 2 == 1
    square = np.where(other[:, None, None, None], costs.square[..., ::-1], costs.square)
    np.testing.assert_array_equal(shift_of(tree, costs._replace(square=square)), 0.0)


def test_a_joint_stays_where_two_shapes_of_its_border_bend_the_limb_at_different_places() -> None:
    tree, costs = costs_of(0.6)
    square = costs.square.copy()
    square[:, :, 1] = square[:, :, 1, ::-1]
    np.testing.assert_array_equal(shift_of(tree, costs._replace(square=square)), 0.0)


def test_frames_that_do_not_show_the_parts_hardly_count() -> None:
    tree, costs = costs_of(0.6)
    square, seen = costs.square.copy(), ALL.copy()
    square[:3], seen[:3, 2] = square[:3, :, :, ::-1], 0.0
    np.testing.assert_allclose(shift_of(tree, costs._replace(square=square), seen), shift_of(tree, costs), atol=0.1)


def test_a_limb_has_an_axis_only_where_its_bones_are_long_and_straight() -> None:
    tree, chosen = costs_of(0.0)[0], HingePlacesSettings()
    end = np.array([0.0, 0.0, 6.0])
    np.testing.assert_allclose(limb_axis(tree, tree.rest, 2, end, chosen), [0.0, 0.0, 1.0], atol=1e-9)
    assert limb_axis(tree, tree.rest, 2, np.array([6.0, 0.0, END]), chosen) is None, "a right angle"
    assert limb_axis(tree, tree.rest, 2, np.array([0.0, 0.0, END + 0.5]), chosen) is None, "half a radius"


def test_joints_of_parts_without_length_are_not_laid() -> None:
    surface, found = three_parts(FRAMES)
    tree = in_tree_order(found, 3)
    meshes = Frames(turning()[:FRAMES])
    costs = hinge_costs(
        surface.V, surface.F, surface.area, tree._replace(radius=40.0 * tree.radius), {0: Target.of(*meshes(0), surface.size)}
    )
    assert len(costs.joint) == 0
    assert costs.square.shape == (1, 0, 2, len(HingePlacesSettings().places))


@pytest.mark.parametrize(("gain", "way"), [(0.03, 0.0), (0.05, 0.5)])
def test_a_joint_moves_only_where_the_best_place_leaves_clearly_less(gain: float, way: float) -> None:
    tree, costs = costs_of(0.0)
    np.testing.assert_allclose(shift_of(tree, least_at(costs, 0.5, gain))[2], way * tree.radius[2], atol=1e-9)


def test_a_joint_stays_where_the_least_cost_is_at_the_end_of_the_places() -> None:
    tree, costs = costs_of(0.0)
    anyhow = HingePlacesSettings(share=9.0, carried_apart=9.0)
    inside, beyond = (hinge_shifts(tree, least_at(costs, at, 0.5), tree.rest, ALL, (), anyhow) for at in (2.5, 3.5))
    assert inside[2].any()
    np.testing.assert_array_equal(beyond[2], 0.0)


def test_joints_do_not_go_farther_than_half_of_the_bone_on_that_side() -> None:
    tree, costs = costs_of(0.0)
    rest = tree.rest.copy()
    rest[1, 2] = rest[2, 2] - 1.5 * tree.radius[2]
    short, anyhow = tree._replace(rest=rest), HingePlacesSettings(carried_apart=9.0)

    def moves(place: float) -> bool:
        return bool(hinge_shifts(short, least_at(costs, place, 0.5), rest, ALL, (), anyhow)[2].any())

    assert not moves(-0.8)
    assert moves(-0.7)
    assert moves(0.8), "the bone beyond is longer"


@pytest.mark.parametrize(
    ("before", "after", "moves"), [(0.0, 0.24, True), (0.0, 0.26, False), (0.1, 0.29, True), (0.1, 0.31, False)]
)
def test_a_joint_does_not_go_where_its_parts_are_carried_apart(
    before: float, after: float, moves: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Drifts in radii."""
    tree, costs = costs_of(0.0)
    drifts = iter([before * tree.radius, after * tree.radius])
    monkeypatch.setattr(FirstTree, "drift_at", lambda *of: next(drifts))
    assert shift_of(tree, least_at(costs, 0.5, 0.5)).any() == moves


def forked(lateral: float, behind: float = 2.0) -> tuple[FirstTree, HingeCosts]:
    """The middle part as the root, its place 1.2 radii before the last joint; its other joint so far aside and behind."""
    tree, costs = costs_of(0.0)
    radius = tree.radius[2]
    other, root = tree.rest[2] + radius * np.array([[lateral, 0.0, -behind], [0.0, 0.0, -1.2]])
    forked = tree._replace(parents=np.array([-1, 0, 0]), rest=np.array([root, other, tree.rest[2]]))
    return forked, costs


@pytest.mark.parametrize(
    ("lateral", "behind", "way", "goes"),
    [
        (0.0, 2.0, -0.9, True),
        (0.0, 2.0, -1.1, False),
        (4.0, 2.0, -0.7, False),
        (4.0, 2.0, -0.5, True),
        (0.0, -2.0, -0.7, False),
    ],
    ids=["half-way to a joint behind", "farther", "none behind: half-way to the root", "nearer", "the other is beyond"],
)
def test_the_root_has_no_joint_so_that_the_next_joint_behind_it_bounds_the_way(
    lateral: float, behind: float, way: float, goes: bool
) -> None:
    tree, costs = forked(lateral, behind)
    assert shift_of(tree, least_at(costs, way, 0.5)).any() == goes


@pytest.mark.parametrize(
    ("length", "gain", "moves"), [(1.0, 0.1, False), (1.0, 0.2, True), (0.25, 0.5, False), (1.4, 0.1, True)]
)
def test_joints_of_short_bones_move_only_where_far_less_is_left(length: float, gain: float, moves: bool) -> None:
    tree, costs = costs_of(0.0)
    rest = tree.rest.copy()
    rest[1, 2] = rest[2, 2] - length * tree.radius[2]
    assert shift_of(tree._replace(rest=rest), least_at(costs, 0.5, gain)).any() == moves


def test_joints_of_short_bones_do_not_move_where_these_are_bent() -> None:
    tree, costs = costs_of(0.0)
    bent, straight = (
        costs._replace(end=tree.rest[1:] + tree.radius[2] * np.array([np.sqrt(1.0 - c * c), 0.0, c])) for c in (0.6, 0.8)
    )
    assert not shift_of(tree, least_at(bent, 0.5, 0.5)).any()
    assert shift_of(tree, least_at(straight, -0.5, 0.5)).any()


def test_joints_of_a_trunk_that_the_frames_divide_need_the_gain_of_short_bones() -> None:
    tree, costs = costs_of(0.0)
    divided = tree._replace(shown=(1,))
    assert divided.in_divided_trunk.tolist() == [False, True, True]
    assert not shift_of(divided, least_at(costs, 0.5, 0.1)).any()
    assert shift_of(divided, least_at(costs, 0.5, 0.2)).any()


def test_joints_of_short_bones_have_no_offset() -> None:
    tree, costs = costs_of(0.0)
    rest = tree.rest.copy()
    rest[1, 2] = rest[2, 2] - tree.radius[2]
    at = least_at(costs, 0.5, 0.5)
    assert shift_of(tree._replace(rest=rest), at).any()
    assert np.isnan(hinge_offsets(tree, at, rest, ALL)[2])


def test_a_bend_in_one_of_two_takes_moves_the_joint() -> None:
    tree, costs = costs_of(0.0)
    square = np.ones(costs.square.shape)
    square[:8] = 100.0 * least_at(costs, -0.5, 0.02).square[:8]
    square[8:] = least_at(costs, 0.5, 0.5).square[8:]
    both = costs._replace(square=square)
    first = np.arange(FRAMES) < 8
    spans = [np.ones(FRAMES, np.bool_), first, ~first]
    assert not shift_of(tree, both).any(), "over all frames little is gained"
    np.testing.assert_allclose(hinge_shifts(tree, both, tree.rest, ALL, spans)[2], [0.0, 0.0, 0.5 * tree.radius[2]], atol=1e-9)


def test_the_offset_is_how_far_the_joint_lies_from_where_halves_bend_the_limb() -> None:
    tree, costs = costs_of(0.0)
    at = least_at(costs, 0.5, 0.5)
    np.testing.assert_allclose(hinge_offsets(tree, at, tree.rest, ALL), [np.nan, *0.5 * tree.radius[1:]], atol=1e-9)
    rest = tree.rest.copy()
    rest[2, 2] += 0.5 * tree.radius[2]
    assert hinge_offsets(tree, at, rest, ALL)[2] == pytest.approx(0.0, abs=1e-9)
    square = np.where(np.arange(FRAMES)[:, None, None, None] % 2, at.square, least_at(costs, -0.5, 0.5).square)
    apart = hinge_offsets(tree, costs._replace(square=square), tree.rest, ALL)[2]
    assert 0.3 * tree.radius[2] < apart < 0.5 * tree.radius[2], "second frames disagree by a radius, second quarters do not"


def test_ways_are_those_to_the_places_of_halves() -> None:
    tree, costs = costs_of(0.0)
    places, radius = HingePlacesSettings().places, float(tree.radius[2])
    for far, expected in ((0.0, [0.0] * 8), (0.8, [0.0, 0.8, 0.0, 0.0, 0.0, 0.4, 0.0, 0.4]), (9.0, None)):
        square = np.broadcast_to(1.0 + places**2, costs.square.shape).copy()
        square[::2, :, 1] = 1.0 + (places - far) ** 2
        ways = hinge_ways(tree, costs._replace(square=square), tree.rest, ALL)
        if expected is None:
            assert np.isinf(ways[2]).any()
        else:
            np.testing.assert_allclose(ways[2], radius * np.array(expected), atol=1e-9)
        assert 0 not in ways, "nothing was tried there"


def test_a_limb_that_bends_beyond_all_places_has_the_offset_of_the_last_and_a_bent_limb_has_none() -> None:
    tree, costs = costs_of(0.0)
    reach = HingePlacesSettings().reach
    assert hinge_offsets(tree, least_at(costs, 3.5, 0.5), tree.rest, ALL)[2] == pytest.approx(reach * tree.radius[2])
    bent = costs._replace(end=tree.rest[1:] + np.array([6.0, 0.0, 0.0]))
    assert np.isfinite(hinge_offsets(tree, bent, tree.rest, ALL)).tolist() == [False, True, False]


def test_one_noisy_frame_repeated_moves_no_joint() -> None:
    surface, found = three_parts(24)
    tree, still = in_tree_order(found, 3), np.tile(np.eye(3), (24, 3, 1, 1))
    rest = tree.rest.copy()
    rest[1], rest[2] = 0.0, [0.0, 0.0, END]
    tree = tree._replace(rest=rest, R=still, t=np.zeros((24, 3, 3)))
    V, F = Frames(still)(0)
    target = Target.of(V + np.random.default_rng(5).normal(0.0, 0.02, V.shape), F, surface.size)
    costs = hinge_costs(surface.V, surface.F, surface.area, tree, dict.fromkeys(range(24), target))
    always = HingePlacesSettings(gain=0.0)
    assert hinge_shifts(tree, costs, rest, np.ones((24, 3)), (), always).any(), "noise alone would move one"
    np.testing.assert_array_equal(hinge_shifts(tree, costs, rest, np.ones((24, 3))), 0.0)


def room(parents: list[int], heights: list[float], joint: int, aside: float = 0.0) -> tuple[float, float]:
    """Of a joint among others at these heights; the bone beyond it ends two above, and the last part lies so far aside."""
    rest = np.stack([np.zeros(len(heights)), np.zeros(len(heights)), np.array(heights)], axis=1)
    rest[-1, 0] = aside
    tree = cast(FirstTree, SimpleNamespace(parents=np.array(parents)))
    up = np.array([0.0, 0.0, 1.0])
    above, below = hinge_places._room(tree, rest, joint, rest[joint] + 2.0 * up, up, HingePlacesSettings())
    return round(float(above), 6), round(float(below), 6)


@pytest.mark.parametrize(
    ("parents", "heights", "joint", "aside", "above"),
    [
        ([-1, 0, 0, 0], [4.0, 5.0, 2.0, 1.0], 1, 0.0, 3.0),
        ([-1, 0, 0, 0], [4.0, 5.0, 7.0, 6.0], 1, 0.0, 1.0),
        ([-1, 0, 0, 0], [4.0, 5.0, 7.0, 4.0], 1, 3.0, 1.0),
        ([-1, 0, 1, 0], [0.0, 2.0, 5.0, 4.0], 2, 0.0, 3.0),
    ],
    ids=["the nearest behind", "none behind: the root's place", "one far aside", "not on the root: the joint above"],
)
def test_room_beside_the_root_goes_to_the_nearest_joint_behind(
    parents: list[int], heights: list[float], joint: int, aside: float, above: float
) -> None:
    assert room(parents, heights, joint, aside) == (above, 2.0)
