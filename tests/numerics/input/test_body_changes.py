"""Laws of the change of a body: a lasting step in volume is one; poses, noise, lost limbs, drifts and short visits are none."""

import numpy as np
import pytest

from kinetree.tasks.numerics.input.body_changes import body_changes, other_bodies

RNG = np.random.default_rng(3)


def sizes(*volumes, noise=0.003, of_area=2 / 3):
    """Areas and volumes of bodies of one shape, by frame; `of_area` is how the area follows the volume."""
    volume = np.array(volumes) * np.exp(noise * RNG.standard_normal(len(volumes)))
    return volume**of_area, volume


def test_one_body_does_not_change():
    assert len(body_changes(*sizes(*[7.0] * 40))) == 0
    assert len(body_changes(*sizes(*[7.0] * 40, noise=0.03))) == 0


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e9])
def test_another_body_begins_where_the_volume_steps(scale):
    volumes = np.array([7.0] * 20 + [7.6] * 12 + [7.0] * 9) * scale
    begins = body_changes(*sizes(*volumes))
    assert begins.tolist() == [20, 32]
    assert np.flatnonzero(other_bodies(volumes, begins)).tolist() == list(range(20, 32))


def test_of_two_bodies_shown_equally_often_the_first_is_the_body():
    area, volume = sizes(*[7.0] * 10, *[9.0] * 10)
    assert other_bodies(volume, body_changes(area, volume)).tolist() == [False] * 10 + [True] * 10


def test_limb_that_is_lost_for_good_is_no_other_body():
    area, volume = sizes(*[7.0] * 20)
    arm, leg = (np.where(np.arange(20) < 10, 1.0, 1 - share) for share in (0.09, 0.19))
    assert len(body_changes(area * arm, volume * (1 - (1 - arm) / 2))) == 0
    assert len(body_changes(area * leg, volume * (1 - 0.8 * (1 - leg)))) == 0


def test_drift_and_short_visit_are_no_other_body():
    assert len(body_changes(*sizes(*np.linspace(7.0, 9.0, 40), noise=0.0))) == 0
    assert len(body_changes(*sizes(*[7.0] * 20, *[9.0] * 4, *[7.0] * 20))) == 0


def test_step_must_be_wider_than_either_side_varies():
    wild = np.tile([7.0, 7.4], 5)
    assert len(body_changes(*sizes(*wild, *(wild * 1.10), noise=0.0))) == 0
    assert len(body_changes(*sizes(*wild, *(wild * 1.20), noise=0.0))) == 1


def test_where_the_volume_is_not_known_nothing_is_said():
    area, volume = sizes(*[7.0] * 10, *[9.0] * 10)
    volume[8] = 0.0
    assert len(body_changes(area, volume)) == 0
    volume[8], volume[2] = 7.0, 0.0
    assert body_changes(area, volume).tolist() == [10]
    assert other_bodies(volume, np.array([10])).sum() == 10


def test_short_sequences_say_nothing():
    for count in range(1, 10):
        assert len(body_changes(*sizes(*np.linspace(5.0, 9.0, count)))) == 0
