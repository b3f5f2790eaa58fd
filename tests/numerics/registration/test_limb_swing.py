"""Laws of swung limbs: points in the body go with its nodes, and limbs reach stems that no fit from the last pose reaches."""

import numpy as np
import pytest
from limbs import LENGTH, bent, reaching_body, rotation, tube, twisted
from shipped import GRAPH

from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraphSettings, deformation_graph
from kinetree.tasks.numerics.registration.limb_swing import (
    LimbSwingSettings,
    carried,
    stem_points,
    swings,
    with_two_exchanged,
)
from kinetree.tasks.numerics.registration.near_pose import near_pose, thinned_body, thinned_frame

V, F = tube(around=29, along=57, start=0.07)
FAR = 1.8
"""Radians; a fit from rest does not reach it."""
HEIGHTS = np.array([0.5, 1.5, 2.5, 3.5, 4.5])
STEMS = np.stack([np.outer(side * HEIGHTS, [0.0, 0.0, 1.0]) for side in (-1.0, 1.0)])
"""(limb, station, xyz) of the tube at rest, its lower and its upper half."""
NONE = np.zeros((0, 5, 3))


def bent_stems(angle, order=(1, 0)):
    """Stems and centre of the bent tube as a frame shows them, in an order of its own."""
    return np.stack([bent(stem, angle) for stem in STEMS])[list(order)], bent(V, angle).mean(axis=0)


@pytest.fixture(scope="module")
def reaching():
    """The body that reaches, with a deformation graph of 150 nodes · its stems."""
    surface, faces, stems = reaching_body()
    return deformation_graph(surface, faces, GRAPH._replace(nodes=150)), stems


def test_points_at_rest_lie_where_they_are_and_turn_with_the_body(body):
    points = stem_points(body, STEMS)
    np.testing.assert_allclose(points.weight.sum(axis=1), 1.0)
    np.testing.assert_allclose(carried(body, at_rest(body), points), STEMS.reshape(-1, 3), atol=1e-12)
    R = rotation((1, 2, 0), 0.7)
    turned = Pose(np.tile(R, (len(body.node), 1, 1)), body.g @ R.T)
    np.testing.assert_allclose(carried(body, turned, points), STEMS.reshape(-1, 3) @ R.T, atol=1e-12)


def test_a_limb_that_no_fit_from_the_last_pose_reaches_is_reached_from_where_it_was_swung(body):
    thin, frame = thinned_body(body), thinned_frame(bent(V, FAR), F, body.size)
    starts = at_rest(body), swings(thin, at_rest(body), STEMS, *bent_stems(FAR))[0]
    lost, found = (near_pose(thin, start, frame) for start in starts)
    assert lost.distant > 0.3
    assert found.distant < 0.1
    left, error = (np.linalg.norm(shape(body, near.pose)[0] - bent(body.V, FAR), axis=1).mean() for near in (lost, found))
    assert left > 0.1 * LENGTH
    assert error < 0.03 * LENGTH


def test_limbs_that_are_where_they_were_stay(body):
    still = swings(body, at_rest(body), STEMS, *bent_stems(0.0))[0]
    np.testing.assert_allclose(shape(body, still)[0], body.V, atol=0.01 * LENGTH)


def test_limbs_are_told_apart_about_the_centre_wherever_the_body_has_gone(body):
    away = np.array([0.0, 0.0, LENGTH])
    stems, centre = bent_stems(0.3)
    here, there = (swings(body, at_rest(body), STEMS, stems + shift, centre + shift)[0] for shift in (0.0 * away, away))
    np.testing.assert_allclose(shape(body, there)[0], shape(body, here)[0] + away, atol=0.01 * LENGTH)


def test_a_limb_that_the_frame_does_not_show_goes_along_with_the_others(body):
    stems, centre = bent_stems(0.0)
    shift = np.array([0.0, 2.0, 0.0])
    found = swings(body, at_rest(body), STEMS, stems[:1] + shift, centre + shift)[0]
    np.testing.assert_allclose(shape(body, found)[0], body.V + shift, atol=0.05 * LENGTH)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 1, 0, 2)])
def test_arms_stay_on_their_sides_where_the_trunk_twists_and_each_comes_nearer_to_the_place_of_the_other_one(reaching, order):
    body, stems = reaching
    goal = twisted(stems, 1.65)
    assert np.linalg.norm(goal[1::-1] - stems[:2], axis=2).mean() < np.linalg.norm(goal[:2] - stems[:2], axis=2).mean()
    centre = twisted(shape(body, at_rest(body))[0][body.sample], 1.65).mean(axis=0)
    swing = swings(body, at_rest(body), stems, goal[list(order)], centre)[0]
    np.testing.assert_allclose(carried(body, swing, stem_points(body, stems)), goal.reshape(-1, 3), atol=1.0)


def off(reaching, angle, settings=None):
    """(limb,) how far the limbs of the body at rest end from where they are, after its trunk has twisted."""
    body, stems = reaching
    centre = twisted(shape(body, at_rest(body))[0][body.sample], angle).mean(axis=0)
    goal = twisted(stems, angle)
    swing = swings(body, at_rest(body), stems, goal, centre, settings)[0]
    carried_to = carried(body, swing, stem_points(body, stems)).reshape(stems.shape)
    return np.linalg.norm(carried_to - goal, axis=2).mean(axis=1)


@pytest.mark.parametrize("strict", [{"exchange": 0.1}, {"begun": 0.5}])
def test_limbs_keep_the_nearest_stems_where_the_body_would_not_bend_clearly_less(reaching, strict):
    assert off(reaching, 1.65).max() < 1.0
    assert off(reaching, 1.65, LimbSwingSettings(**strict))[:2].min() > 3.0


@pytest.mark.parametrize(
    ("angle", "likely", "right"),
    [
        (1.65, 2.0, [True]),
        (2.0, 1.15, [True]),
        (2.0, 2.0, [True, False]),
        (2.1, 2.0, [False, True]),
        (2.1, 1.0, [False]),
    ],
)
def test_where_both_ways_of_swinging_the_arms_are_likely_both_are_given(reaching, angle, likely, right):
    """Turned by 120°, either arm may as well have gone the other way round; the way of less energy comes first."""
    body, stems = reaching
    goal = twisted(stems, angle)
    centre = twisted(shape(body, at_rest(body))[0][body.sample], angle).mean(axis=0)
    settings = LimbSwingSettings(likely=likely)
    found = swings(body, at_rest(body), stems, goal, centre, settings)
    points = stem_points(body, stems)
    off = [np.linalg.norm(carried(body, pose, points).reshape(stems.shape) - goal, axis=2).mean(axis=1)[:2] for pose in found]
    assert [arms.max() < 1.0 for arms in off] == right
    assert [arms.min() > 3.0 for arms in off] == [not way for way in right]
    assert len(swings(body, at_rest(body), stems, goal, centre, settings._replace(ways=1))) == 1


def test_without_limbs_nothing_is_swung(body):
    stems, centre = bent_stems(0.3)
    assert swings(body, at_rest(body), NONE, stems, centre) == []
    assert swings(body, at_rest(body), STEMS, NONE, centre) == []


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0])
@pytest.mark.parametrize("away", [0.0, 300.0])
def test_a_piece_that_lies_apart_and_has_no_limb_goes_along_with_the_body(turn, away):
    R, shift = rotation((1, 2, 0), turn), away * np.array([1.0, -2.0, 0.5])
    both = np.concatenate([V, 0.1 * V + [2.0, 0.0, 0.0]]) @ R.T + shift
    graph = deformation_graph(both, np.concatenate([F, F + len(V)]), DeformationGraphSettings(200, 0.4, 0.08, 0.15, 8))
    stems, apart = STEMS @ R.T + shift, np.arange(len(both)) >= len(V)
    raised = np.array([0.0, 0.5, 0.0])
    centre = shape(graph, at_rest(graph))[0][graph.sample].mean(axis=0)
    found = swings(graph, at_rest(graph), stems, stems + raised, centre + raised)[0]
    np.testing.assert_allclose(shape(graph, found)[0][apart], both[apart] + raised, atol=0.02 * LENGTH)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 1, 0, 2)])
@pytest.mark.parametrize("angle", [1.65, 2.0])
def test_arms_that_were_exchanged_are_where_they_belong_in_the_pose_of_least_energy(reaching, angle, order):
    body, stems = reaching
    goal, points = twisted(stems, angle), stem_points(body, stems)
    centre = shape(body, at_rest(body))[0][body.sample].mean(axis=0)
    wrong = swings(body, at_rest(body), stems, goal, centre, LimbSwingSettings(exchange=0.0))[0]
    assert np.linalg.norm(carried(body, wrong, points) - goal.reshape(-1, 3), axis=1)[:10].min() > 1.5
    found = with_two_exchanged(body, wrong, stems, goal[list(order)])
    np.testing.assert_allclose(carried(body, found[0], points), goal.reshape(-1, 3), atol=1.0)


def test_limbs_that_are_right_have_no_exchange_as_likely_and_ways_are_at_most_as_many_as_asked_for(reaching):
    body, stems = reaching
    assert with_two_exchanged(body, at_rest(body), stems, twisted(stems, 0.5)) == []
    every = LimbSwingSettings(stages=((2, np.inf),), pairs=5, ways=4)
    assert len(with_two_exchanged(body, at_rest(body), stems, twisted(stems, 0.5), every)) == 4


@pytest.mark.parametrize(("limbs", "shown"), [(1, 4), (4, 1), (0, 4), (4, 0)])
def test_one_limb_has_none_to_be_exchanged_with(reaching, limbs, shown):
    body, stems = reaching
    assert with_two_exchanged(body, at_rest(body), stems[:limbs], stems[:shown], LimbSwingSettings(stages=((2, np.inf),))) == []


def test_a_limb_without_length_is_the_least_alike_and_no_matter(reaching):
    body, stems = reaching
    stems = np.concatenate([stems, np.tile([0.0, 0.0, 3.9], (1, 5, 1))])
    assert with_two_exchanged(body, at_rest(body), stems, twisted(stems, 0.5)) == []


@pytest.mark.parametrize(("limbs", "shown"), [(4, 3), (3, 4)])
def test_what_the_frame_does_not_show_and_what_no_limb_has_is_not_exchanged(reaching, limbs, shown):
    body, stems = reaching
    every = LimbSwingSettings(stages=((2, np.inf),), pairs=6, ways=6)
    assert len(with_two_exchanged(body, at_rest(body), stems[:limbs], stems[:shown], every)) == 3


@pytest.mark.parametrize("order", [(2, 0, 3, 1), (3, 1, 0, 2)])
def test_limbs_alike_in_length_are_exchanged_in_whatever_order_the_frame_shows_them(reaching, order):
    body, stems = reaching
    both = LimbSwingSettings(stages=((5, np.inf),), pairs=2)
    sorted_, shuffled = (with_two_exchanged(body, at_rest(body), stems, stems[list(of)], both) for of in ((0, 1, 2, 3), order))
    assert len(sorted_) == 2
    for one, other in zip(sorted_, shuffled, strict=True):
        np.testing.assert_allclose(other.translation, one.translation, atol=1e-6)
