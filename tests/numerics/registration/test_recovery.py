"""Laws of finding frames in which tracking failed and of tracking them again from the frame beyond, on tubes."""

import numpy as np
from limbs import ANGLES, LENGTH, bent, rotation, tube
from shipped import FITTING

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, shape
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs
from kinetree.tasks.numerics.registration.recovery import failures, recovery
from kinetree.tasks.numerics.registration.tracking import TrackingSettings, tracking

SETTINGS = TrackingSettings()


def test_failures_stand_out_from_the_sequence():
    share = np.array([0.001, 0.002, 0.001, 0.03, 0.002, 0.001])
    np.testing.assert_array_equal(failures(share), share > 0.02)
    assert not failures(np.full(9, 0.02)).any()
    assert not failures(np.array([0.0, 0.0, SETTINGS.uncovered / 2])).any()


def test_a_lost_frame_is_found_again_from_the_frame_beyond_it(body, targets):
    good, last = [], at_rest(body)
    for target in targets:
        good.append(tracking(body, None, last, target, FITTING))
        last = good[-1].pose
    lost = Pose(np.tile(rotation((1, 0, 0), np.pi / 2), (len(body.node), 1, 1)), body.g @ rotation((1, 0, 0), np.pi / 2).T)
    poses = [*(frame.pose for frame in good[:3]), lost, good[4].pose]
    share = np.array([*(frame.uncovered for frame in good[:3]), 0.3, good[4].uncovered])
    found = recovery(body, share, poses.__getitem__, targets.__getitem__, 0, FITTING)
    assert list(found.recovered) == [3]
    assert found.recovered[3].uncovered <= SETTINGS.uncovered
    true = bent(body.V, ANGLES[3])
    assert np.linalg.norm(shape(body, found.recovered[3].pose)[0] - true, axis=1).mean() < 0.01 * LENGTH


def test_the_last_frame_of_a_chain_is_found_again_from_the_two_before_it(body):
    V, F = tube(around=29, along=57, start=0.07)
    turned = [rotation((1, 0, 0), k * 0.9) for k in range(5)]
    frames = [Target.of(V @ R.T, F, body.size) for R in turned]
    good = [Pose(np.tile(R, (len(body.node), 1, 1)), body.g @ R.T) for R in turned]
    share = np.array([0.0, 0.001, 0.001, 0.001, 0.3])
    found = recovery(body, share, [*good[:4], at_rest(body)].__getitem__, frames.__getitem__, 0, FITTING)
    assert list(found.recovered) == [4]
    assert np.linalg.norm(shape(body, found.recovered[4].pose)[0] - body.V @ turned[4].T, axis=1).mean() < 0.01 * LENGTH


def test_a_lost_frame_that_no_neighbour_reaches_is_found_again_from_the_limbs_that_it_shows(body):
    V, F = tube(around=29, along=57, start=0.07)
    away = np.array([0.0, 3.0 * LENGTH, 0.0])
    frame, share = Target.of(V + away, F, body.size), np.array([0.001, 0.3, 0.001, 0.001, 0.0])
    halves = np.stack([np.outer(side * np.array([0.5, 1.5, 2.5, 3.5, 4.5]), [0.0, 0.0, 1.0]) for side in (-1.0, 1.0)])
    asked = []

    def limbs(at):
        asked.append(at)
        return FrameLimbs(halves, halves + away, away)

    alone, led = (
        recovery(body, share, lambda at: at_rest(body), lambda at: frame, 4, FITTING, limbs=known).recovered
        for known in (None, limbs)
    )
    assert set(asked) == {1}
    assert led[1].uncovered < 0.01
    assert np.linalg.norm(shape(body, led[1].pose)[0] - body.V - away, axis=1).mean() < 0.01 * LENGTH
    assert 1 not in alone or alone[1].uncovered > 0.1


def test_good_frames_and_the_reference_are_left_alone(body):
    def refused(at: int):
        raise AssertionError(f"frame {at} was asked for")

    found = recovery(body, np.array([0.5, 0.001, 0.001, 0.001, 0.001]), refused, refused, 0, FITTING)
    assert not found.failed.any()
    assert not found.recovered
    assert found.usual == 0.001


def test_a_single_frame_has_nothing_usual(body):
    assert recovery(body, np.zeros(1), lambda at: at_rest(body), lambda at: None, 0, FITTING).usual == 1.0
