"""Laws of tracking one frame from its neighbour, on tubes."""

import numpy as np
import pytest
from limbs import LENGTH, rotation, tube
from scipy.spatial.transform import Rotation
from shapes import y_pipe
from shipped import FITTING, GRAPH

from kinetree.tasks.numerics.registration import tracking as module
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, bending, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs, LimbSwingSettings, swings
from kinetree.tasks.numerics.registration.tracking import (
    Tracking,
    TrackingSettings,
    attempts,
    distant_share,
    entered,
    predicted,
    stepped_back,
    tracking,
)

SETTINGS = TrackingSettings()
HALVES = np.stack([np.outer(side * np.array([0.5, 1.5, 2.5, 3.5, 4.5]), [0.0, 0.0, 1.0]) for side in (-1.0, 1.0)])
"""(limb, station, xyz) of the tube at rest, its lower and its upper half."""


def rigid(body, R, t):
    return Pose(np.tile(R, (len(body.node), 1, 1)), body.g @ R.T + t)


def test_a_frame_that_is_followed_is_covered_at_the_first_attempt(body, targets):
    found = tracking(body, None, at_rest(body), targets[1], FITTING)
    assert (found.attempt, found.uncovered) == (0, pytest.approx(0.0, abs=SETTINGS.uncovered))


def test_a_limb_that_moved_on_steadily_is_found_from_where_it_should_be(body):
    V, F = tube(around=29, along=57, start=0.07)
    step = 0.9
    before, last = (rigid(body, rotation((1, 0, 0), k * step), np.zeros(3)) for k in (1, 2))
    target = Target.of(V @ rotation((1, 0, 0), 3 * step).T, F, body.size)
    alone, led = (tracking(body, b, last, target, FITTING) for b in (None, before))
    assert led.uncovered <= min(SETTINGS.uncovered, alone.uncovered)
    x = shape(body, led.pose)[0]
    assert np.linalg.norm(x - body.V @ rotation((1, 0, 0), 3 * step).T, axis=1).mean() < 0.01 * LENGTH


def test_a_limb_that_no_other_way_reaches_is_found_at_last_from_where_it_was_swung(body):
    V, F = tube(around=29, along=57, start=0.07)
    away = np.array([0.0, 3.0 * LENGTH, 0.0])
    target, limbs = Target.of(V + away, F, body.size), FrameLimbs(HALVES, HALVES + away, away)
    alone, led = (tracking(body, None, at_rest(body), target, FITTING, limbs=known) for known in (None, limbs))
    assert alone.uncovered > 0.1
    assert led.attempt == len(attempts(FITTING))
    assert led.uncovered <= SETTINGS.uncovered


def raised(points, angle, at=8.0, blend=8.0):
    """What lies beyond `at` along x turned up about it."""
    share = np.clip((points[:, 0] - at) / blend + 0.5, 0.0, 1.0)
    turn = angle * share * share * (3 - 2 * share)
    x, z = points[:, 0] - at, points[:, 2]
    return np.stack([at + np.cos(turn) * x - np.sin(turn) * z, points[:, 1], np.sin(turn) * x + np.cos(turn) * z], axis=1)


def crossed(graph, way, angle, base=4.0):
    """The pose in which the second and the third of three arms have passed each other."""
    along = graph.g @ way.T
    arm = np.where(along.max(axis=1) > base, along.argmax(axis=1), 0)
    R = np.stack([np.eye(3), rotation((0, 0, 1), angle), rotation((0, 0, 1), -angle)])[arm]
    hinge = base * way[arm]
    return Pose(R, np.einsum("nxy,ny->nx", R, graph.g - hinge) + hinge)


def test_exchanged_limbs_that_cover_more_but_bend_much_more_are_not_taken(monkeypatch):
    nearest = LimbSwingSettings(exchange=0.0, likely=0.0)
    monkeypatch.setattr(module, "swings", lambda *a: swings(*a, nearest))
    V, F, _ = y_pipe()
    graph = deformation_graph(V, F, GRAPH._replace(nodes=120))
    around = 2 * np.pi * np.arange(3) / 3
    way = np.stack([np.cos(around), np.sin(around), np.zeros(3)], axis=1)
    stems = np.linspace(4.0, 24.0, 5)[None, :, None] * way[:, None]
    there = raised(V, 1.6)
    limbs = FrameLimbs(stems, np.stack([raised(stems[0], 1.6), *stems[1:]]), there.mean(axis=0))
    neighbour, target = crossed(graph, way, 1.4), Target.of(there, F, graph.size)
    however_bent, judged = (
        tracking(graph, None, neighbour, target, FITTING, settings=settings, limbs=limbs)
        for settings in (TrackingSettings(bent=1e9), SETTINGS)
    )
    second = V @ way[1] > 12.0
    exchanged, right = ((shape(graph, one.pose)[0][second] @ way[1:].T).mean(axis=0) for one in (however_bent, judged))
    assert however_bent.attempt == len(attempts(FITTING))
    assert however_bent.uncovered < 0.5 * judged.uncovered
    assert exchanged[1] > 12.0
    assert right[0] > 12.0


def test_a_missing_half_is_reported_as_uncovered(body):
    V, F = tube(around=29, along=57)
    longer = V + np.where(V[:, 2:] > 0, 1.0, 0.0) * [0, 0, LENGTH]
    found = tracking(body, None, at_rest(body), Target.of(longer, F, body.size), FITTING)
    assert found.uncovered > 0.1


def test_what_no_frame_on_the_way_could_cover_is_not_sought_again(body):
    V, F = tube(around=29, along=57)
    longer = Target.of(V + np.where(V[:, 2:] > 0, 1.0, 0.0) * [0, 0, LENGTH], F, body.size)
    assert tracking(body, None, at_rest(body), longer, FITTING, usual=1.0).attempt == 0


def test_what_is_far_in_all_frames_is_not_sought_again_where_a_take_is_entered(body, monkeypatch):
    V, F = tube(around=29, along=57)
    longer = Target.of(V + np.where(V[:, 2:] > 0, 1.0, 0.0) * [0, 0, LENGTH], F, body.size)
    starts, fits = [at_rest(body)] * 2, []
    monkeypatch.setattr(module, "fit", lambda *a: fits.append(a) or fit(*a))
    assert entered(body, starts, longer, FITTING, distant=1.0).attempt == 0
    assert len(fits) == len(starts)


def test_a_fold_that_no_way_covers_but_that_lies_near_is_not_sought_again(body, monkeypatch):
    V, F = tube(around=29, along=57)
    inner = F[V[F, 2].max(axis=1) < V[:, 2].min() + 0.3 * LENGTH][:, ::-1]
    folded = Target.of(np.concatenate([V, 0.97 * V]), np.concatenate([F, inner + len(V)]), body.size)
    fits = []
    monkeypatch.setattr(module, "fit", lambda *a: fits.append(a) or fit(*a))
    found = tracking(body, None, at_rest(body), folded, FITTING)
    assert found.uncovered > 2 * SETTINGS.uncovered
    assert distant_share(body, found.pose, folded) == 0
    assert len(fits) == 1


def test_the_distant_share_is_the_share_of_a_frame_far_from_the_body(body):
    V, F = tube(around=29, along=57)
    there = Target.of(V, F, body.size)
    assert distant_share(body, at_rest(body), there) == 0
    assert distant_share(body, rigid(body, np.eye(3), np.array([10 * LENGTH, 0, 0])), there) == 1


def test_the_prediction_of_a_steady_turn_is_the_next_step_of_it(body):
    R = [rotation((1, 2, 0), k * 0.3) for k in range(3)]
    steady = [rigid(body, r, k * np.array([1.0, 0, 0])) for k, r in enumerate(R)]
    found = predicted(steady[0], steady[1])
    np.testing.assert_allclose(found.rotation, steady[2].rotation, atol=1e-12)
    np.testing.assert_allclose(predicted(steady[0], steady[0]).translation, steady[0].translation)


def test_a_step_of_another_length_is_predicted_as_many_times_as_long(body):
    R = [rotation((1, 2, 0), k * 0.3) for k in range(4)]
    steady = [rigid(body, r, k * np.array([1.0, 0, 0])) for k, r in enumerate(R)]
    assert stepped_back(steady[1], steady[2], 1.0) is steady[1]
    for earlier, last, ahead, there in ((0, 2, 0.5, 3), (0, 1, 2.0, 3)):
        found = predicted(stepped_back(steady[earlier], steady[last], ahead), steady[last])
        np.testing.assert_allclose(found.rotation, steady[there].rotation, atol=1e-12)
        moved = steady[last].translation + ahead * (steady[last].translation - steady[earlier].translation)
        np.testing.assert_allclose(found.translation, moved, atol=1e-9)


def test_later_attempts_reach_further_and_try_longer():
    first, *others = attempts(FITTING)
    assert first.start == "neighbour"
    assert max(a.settings.reach[0] for a in others) > first.settings.reach[0]
    assert max(a.settings.steps for a in others) > first.settings.steps


def wrung(body, angle):
    """The tube with its upper half turned about its own axis."""
    turn = angle * np.clip(body.g[:, 2] / LENGTH + 0.5, 0.0, 1.0)
    R = Rotation.from_rotvec(np.outer(turn, [0.0, 0.0, 1.0])).as_matrix()
    return Pose(R, np.einsum("nxy,ny->nx", R, body.g))


@pytest.mark.parametrize(
    ("angles", "uncovered", "before", "most", "taken"),
    [
        ((2.0, 0.5), (0.010, 0.012), 0.020, 1.1, 1),
        ((2.0, 0.5), (0.010, 0.016), 0.020, 1.1, 0),
        ((2.0, 1.95), (0.010, 0.010), 0.020, 1.1, 0),
        ((0.5, 2.0), (0.010, 0.008), 0.020, 1.1, 0),
        ((2.0, 0.5), (0.010, 0.012), 0.009, 1.1, None),
        ((2.0, 1.9), (0.010, 0.012), 0.020, 0.5, None),
    ],
)
def test_of_two_ways_to_swing_limbs_the_second_counts_where_it_covers_as_much_and_bends_clearly_less(
    body, monkeypatch, angles, uncovered, before, most, taken
):
    """None is taken where the frame is covered more without, or where both bend more than allowed: `most` times the widest."""
    rest, *ways = (wrung(body, angle) for angle in (0.0, *angles))
    left = {id(pose): share for pose, share in zip(ways, uncovered, strict=True)}
    monkeypatch.setattr(module, "swings", lambda *_: ways)
    monkeypatch.setattr(module, "_attempted", lambda _, start, *__: Tracking(start, left[id(start)], 5))
    limbs = FrameLimbs(np.zeros((1, 2, 3)), np.zeros((1, 2, 3)), np.zeros(3))
    settings = SETTINGS._replace(bent_more=most * bending(body, wrung(body, 2.0)) / body.size**2)
    found = module._by_limbs(body, Tracking(rest, before, 0), rest, limbs, None, FITTING, settings)
    assert found.pose is (rest if taken is None else ways[taken])
