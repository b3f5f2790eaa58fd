"""Laws of near poses: few points of both surfaces carry a pose from frame to frame, and show when a limb is lost."""

import numpy as np
import pytest
from limbs import ANGLES, LENGTH, bent, reaching_body, tube, twisted
from scipy.spatial.transform import Rotation
from shipped import GRAPH

from kinetree.tasks.numerics.registration import near_pose as module
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, bending, shape
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs, LimbSwingSettings, swings, with_two_exchanged
from kinetree.tasks.numerics.registration.near_pose import (
    NearPose,
    NearPoseSettings,
    distant_points,
    is_lost,
    near_pose,
    nearest_pose,
    put_right,
    thinned_body,
    thinned_frame,
)

SETTINGS = NearPoseSettings()
V, F = tube(around=29, along=57, start=0.07)


def test_a_thinned_body_keeps_its_nodes_and_poses_its_points_as_the_body(body):
    thin = thinned_body(body)
    assert len(thin.V) < len(body.V)
    np.testing.assert_array_equal(thin.g, body.g)
    turned = Pose(at_rest(body).rotation, body.g + [1.0, 2.0, 3.0])
    whole = shape(body, turned)[0]
    assert all((np.abs(whole - x).max(axis=1) < 1e-12).any() for x in shape(thin, turned)[0])


def test_a_thinned_frame_has_as_many_points_as_are_asked_for_and_each_is_its_own_neighbour(body):
    frame = thinned_frame(V, F, body.size, SETTINGS._replace(samples=200))
    assert len(frame.V) == 200
    for point in range(200):
        assert point in frame.ring[frame.start[point] : frame.start[point + 1]]
    assert len(thinned_frame(V, F, body.size, SETTINGS._replace(samples=10**6)).V) == len(V)


def test_near_poses_follow_a_limb_that_bends(body):
    thin, last = thinned_body(body), at_rest(body)
    for angle in ANGLES:
        near = near_pose(thin, last, thinned_frame(bent(V, angle), F, body.size))
        last = near.pose
        assert not is_lost(near, 0.0)
    error = np.linalg.norm(shape(body, last)[0] - bent(body.V, ANGLES[-1]), axis=1)
    assert error.mean() < 0.02 * LENGTH


def test_a_missing_half_is_lost_unless_it_is_usual(body):
    longer = V + np.where(V[:, 2:] > 0, 1.0, 0.0) * [0, 0, LENGTH]
    near = near_pose(thinned_body(body), at_rest(body), thinned_frame(longer, F, body.size))
    assert near.distant > 0.1
    assert is_lost(near, 0.0)
    assert not is_lost(near, near.distant)


def test_the_distant_points_are_those_far_from_the_body(body):
    thin, frame = thinned_body(body), thinned_frame(V, F, body.size)
    rest = at_rest(body)
    assert distant_points(thin, rest, frame) < SETTINGS.lost
    assert distant_points(thin, Pose(rest.rotation, rest.translation + 10 * LENGTH), frame) == 1
    assert is_lost(NearPose(rest, 1.0), 0.0)


def wrung(graph, angle):
    """The tube with its upper half turned about its own axis, which leaves its surface where it is."""
    turn = angle * np.clip(graph.g[:, 2] / LENGTH + 0.5, 0.0, 1.0)
    R = Rotation.from_rotvec(np.outer(turn, [0.0, 0.0, 1.0])).as_matrix()
    return Pose(R, np.einsum("nxy,ny->nx", R, graph.g))


FAR = NearPose(Pose(np.zeros((0, 3, 3)), np.zeros((0, 3))), 0.9)


@pytest.mark.parametrize(
    ("angles", "taken"),
    [((2.0, 0.0), 0.0), ((0.0, 2.0), 0.0), ((2.0, 1.7), 1.7), ((2.0, 1.95), 2.0), ((2.0, 1.7, 0.0), 0.0), ((2.0,), 2.0)],
)
def test_of_poses_that_cover_a_frame_the_first_counts_unless_another_bends_clearly_less(body, angles, taken):
    """Bending grows with the square of the angle: 1.7² is 0.72 of 2², and 1.95² 0.95."""
    thin, frame = thinned_body(body), thinned_frame(V, F, body.size)
    found = nearest_pose(thin, FAR, [wrung(thin, angle) for angle in angles], frame)
    one = near_pose(thin, wrung(thin, taken), frame)
    np.testing.assert_array_equal(found.pose.rotation, one.pose.rotation)


@pytest.mark.parametrize(
    ("angles", "distant", "taken"),
    [
        ((2.0, 1.7), (0.010, 0.012), 1),
        ((2.0, 1.7), (0.010, 0.014), 0),
        ((2.0, 1.85), (0.010, 0.010), 0),
        ((1.0, 2.0), (0.014, 0.010), 1),
        ((2.0, 1.0, 0.5), (0.010, 0.012, 0.012), 2),
    ],
)
def test_of_poses_as_near_the_first_counts_unless_another_bends_clearly_less(body, monkeypatch, angles, distant, taken):
    """As near: to 0.003; clearly: 0.8. Bending grows with the square of the angle."""
    thin, frame = thinned_body(body), thinned_frame(V, F, body.size)
    starts = [wrung(thin, angle) for angle in angles]
    far = {id(start): share for start, share in zip(starts, distant, strict=True)}
    monkeypatch.setattr(module, "near_pose", lambda _, start, *__: NearPose(start, far[id(start)]))
    assert nearest_pose(thin, FAR, starts, frame).pose is starts[taken]


def test_the_pose_from_the_neighbour_counts_if_no_other_lies_nearer(body):
    thin, frame = thinned_body(body), thinned_frame(V, F, body.size)
    near = near_pose(thin, at_rest(thin), frame)._replace(distant=0.0)
    assert nearest_pose(thin, near, [wrung(thin, 2.0)], frame) is near
    assert nearest_pose(thin, near, [], frame) is near
    assert nearest_pose(thin, FAR, [], frame) is FAR


TWIST = 1.65
"""Of the trunk, radians: each arm comes nearer to the place of the other one."""


@pytest.fixture(scope="module")
def twisted_frame():
    """The body that reaches, thinned · the limbs of a frame in which its trunk has twisted · that frame · its pose with arms
    exchanged · where the frame has the body's points.
    """
    surface, faces, stems = reaching_body()
    whole = deformation_graph(surface, faces, GRAPH._replace(nodes=150))
    thin, goal = thinned_body(whole), twisted(stems, TWIST)
    limbs = FrameLimbs(stems, goal, twisted(surface[whole.sample], TWIST).mean(axis=0))
    frame = thinned_frame(twisted(surface, TWIST), faces, whole.size)
    start = swings(whole, at_rest(whole), *limbs, LimbSwingSettings(exchange=0.0))[0]
    return thin, limbs, frame, near_pose(thin, start, frame), twisted(thin.V, TWIST)


def test_arms_that_were_exchanged_are_put_right(twisted_frame):
    body, limbs, frame, wrong, goal = twisted_frame
    assert np.linalg.norm(shape(body, wrong.pose)[0] - goal, axis=1).max() > 5.0
    right = put_right(body, wrong, limbs, frame)
    assert not is_lost(right, 0.0)
    assert np.linalg.norm(shape(body, right.pose)[0] - goal, axis=1).max() < 2.0
    assert put_right(body, right, limbs, frame, SETTINGS._replace(strained=0.0)) is right, "right limbs stay, bent or not"


def test_legs_that_were_exchanged_cover_the_frame_whole_and_are_put_right():
    surface, faces, stems = reaching_body()
    body = thinned_body(deformation_graph(surface, faces, GRAPH._replace(nodes=150)))
    frame = thinned_frame(surface, faces, body.size)
    exchanged = with_two_exchanged(body, at_rest(body), stems, stems, LimbSwingSettings(stages=((40, np.inf),), ways=1))[0]
    wrong = near_pose(body, exchanged, frame)
    for _ in range(3):
        wrong = near_pose(body, wrong.pose, frame)
    assert not is_lost(wrong, 0.0)
    assert np.linalg.norm(shape(body, wrong.pose)[0] - body.V, axis=1).max() > 4.0
    right = put_right(body, wrong, FrameLimbs(stems, stems, np.zeros(3)), frame)
    assert not is_lost(right, 0.0)
    assert np.linalg.norm(shape(body, right.pose)[0] - body.V, axis=1).max() < 0.2


def test_what_bends_little_is_not_looked_at_and_the_limit_is_a_share_of_the_area(twisted_frame):
    body, limbs, frame, wrong, _ = twisted_frame
    bent = bending(body, wrong.pose) / body.size**2
    assert put_right(body, wrong, limbs, frame, SETTINGS._replace(strained=1.01 * bent)) is wrong
    assert put_right(body, wrong, limbs, frame, SETTINGS._replace(strained=0.99 * bent)) is not wrong


def test_an_exchange_that_leaves_more_of_the_frame_far_away_is_not_taken(twisted_frame, monkeypatch):
    body, limbs, frame, wrong, _ = twisted_frame
    rest = at_rest(body)
    unbent = Pose(rest.rotation, rest.translation + [0.0, 0.0, 10.0 * body.size])
    monkeypatch.setattr(module, "with_two_exchanged", lambda *given: [unbent])
    assert put_right(body, wrong, limbs, frame) is wrong


@pytest.mark.parametrize(
    ("angles", "left"),
    [((2.0, 1.0), 1.0), ((2.0, 1.87), 1.87), ((2.0, 1.92), 2.0), ((2.0, 1.5, 1.2), 1.2), ((2.0, 1.7, 1.4), 1.4)],
)
def test_of_exchanges_the_least_bent_counts_if_it_bends_less_than_nine_tenths_as_it_is(body, monkeypatch, angles, left):
    """The angles by which the tube is wrung as it is, and with limbs exchanged: 1.87² is 0.87 of 2², 1.92² is 0.92."""
    thin, frame = thinned_body(body), thinned_frame(V, F, body.size)
    here, *others = (NearPose(wrung(thin, angle), 0.0) for angle in angles)
    monkeypatch.setattr(
        module, "with_two_exchanged", lambda graph, pose, *limbs: [o.pose for o in others] if pose is here.pose else []
    )
    monkeypatch.setattr(module, "near_pose", lambda graph, pose, *given: NearPose(pose, 0.0))
    stems = FrameLimbs(np.zeros((2, 5, 3)), np.zeros((2, 5, 3)), np.zeros(3))
    found = put_right(thin, here, stems, frame, SETTINGS._replace(strained=0.0))
    assert bending(thin, found.pose) == pytest.approx(bending(thin, wrung(thin, left)))


def test_exchanges_go_on_for_as_long_as_they_help_once_for_each_limb_at_most(body, monkeypatch):
    thin, frame = thinned_body(body), thinned_frame(V, F, body.size)
    angles = iter((1.6, 1.2, 0.8))
    monkeypatch.setattr(module, "with_two_exchanged", lambda *given: [wrung(thin, next(angles))])
    monkeypatch.setattr(module, "near_pose", lambda graph, pose, *given: NearPose(pose, 0.0))
    stems = FrameLimbs(np.zeros((2, 5, 3)), np.zeros((2, 5, 3)), np.zeros(3))
    found = put_right(thin, NearPose(wrung(thin, 2.0), 0.0), stems, frame, SETTINGS._replace(strained=0.0))
    assert bending(thin, found.pose) == pytest.approx(bending(thin, wrung(thin, 1.2)))


@pytest.mark.parametrize(
    ("distant", "settled", "left"), [(0.002, 2.0, 1.0), (0.004, 2.0, 2.0), (0.0, 1.04, 2.0), (0.0, 1.2, 1.0)]
)
def test_an_exchange_may_be_hardly_farther_away_and_must_bend_less_than_the_pose_fitted_again(
    body, monkeypatch, distant, settled, left
):
    """settled: the angle by which the tube is wrung once it is fitted again as it is; 1² is 0.92 of 1.04², 0.69 of 1.2²."""
    thin, frame = thinned_body(body), thinned_frame(V, F, body.size)
    here, other = wrung(thin, 2.0), wrung(thin, 1.0)
    fits = {id(here): NearPose(wrung(thin, settled), 0.0), id(other): NearPose(other, distant)}
    monkeypatch.setattr(module, "with_two_exchanged", lambda graph, pose, *limbs: [other] if pose is here else [])
    monkeypatch.setattr(module, "near_pose", lambda graph, pose, *given: fits[id(pose)])
    stems = FrameLimbs(np.zeros((2, 5, 3)), np.zeros((2, 5, 3)), np.zeros(3))
    found = put_right(thin, NearPose(here, 0.0), stems, frame, SETTINGS._replace(strained=0.0))
    assert bending(thin, found.pose) == pytest.approx(bending(thin, wrung(thin, left)))
