"""Laws of the path of a limb through its candidates: evidence of many frames moves it, noise does not."""

import numpy as np

from kinetree.tasks.numerics.registration.roll import chosen_rolls, frame_rolls

FRAMES, TURNS, REFERENCE = 20, 12, 4


def offered_turns(true, depth, noise=0.0, seed=0):
    """angle, misfit (frame, 1, turn): every frame offers the same turns, and fits those near its true one (frame,)."""
    angle = np.tile(2 * np.pi * np.arange(TURNS) / TURNS, (FRAMES, 1))
    angle = np.angle(np.exp(1j * angle))
    away = np.abs(np.angle(np.exp(1j * (angle - np.asarray(true)[:, None]))))
    misfit = 0.2 + depth * np.minimum(away, 1.0) + noise * np.random.default_rng(seed).uniform(size=angle.shape)
    return angle[:, None], misfit[:, None]


def grown():
    """Roll that is zero at the reference and grows to a third of a turn."""
    return np.clip((np.arange(FRAMES) - REFERENCE) * np.radians(15.0), 0.0, np.radians(120.0))


def test_roll_that_grows_is_followed():
    angle, misfit = offered_turns(grown(), 0.1, noise=0.02)
    turn = chosen_rolls(angle, misfit, REFERENCE)[:, 0]
    found = np.where(turn >= 0, angle[np.arange(FRAMES), 0, turn], 0.0)
    assert np.degrees(np.abs(found - grown())).max() < 31.0
    assert (turn[: REFERENCE + 1] == -1).all()


def test_noise_moves_no_limb():
    for seed in range(20):
        angle, misfit = offered_turns(np.zeros(FRAMES), 0.0, noise=0.06, seed=seed)
        assert (chosen_rolls(angle, misfit, REFERENCE) == -1).all()


def test_two_turns_that_fit_alike_leave_the_limb_where_it_is():
    angle, misfit = offered_turns(grown(), 0.1)
    opposite = offered_turns(grown() + np.pi, 0.1)[1]
    assert (chosen_rolls(angle, misfit, REFERENCE) >= 0).any()
    assert (chosen_rolls(angle, np.minimum(misfit, opposite), REFERENCE) == -1).all()


def test_one_frame_alone_moves_no_limb():
    true = np.zeros(FRAMES)
    true[10] = np.radians(120.0)
    angle, misfit = offered_turns(true, 0.2)
    assert (chosen_rolls(angle, misfit, REFERENCE) == -1).all()


def test_a_limb_that_fits_where_it_is_stays():
    angle, misfit = offered_turns(np.zeros(FRAMES), 0.2, noise=0.05)
    assert (chosen_rolls(angle, misfit, REFERENCE) == -1).all()


def test_the_reference_is_never_turned_whatever_it_says():
    angle, misfit = offered_turns(np.full(FRAMES, np.radians(90.0)), 0.2)
    turn = chosen_rolls(angle, misfit, REFERENCE)[:, 0]
    assert turn[REFERENCE] == -1
    assert (turn[REFERENCE + 4 :] == 3).all()


def test_time_may_run_either_way_and_limbs_do_not_know_each_other():
    angle, misfit = offered_turns(grown(), 0.1, noise=0.02)
    still = offered_turns(np.zeros(FRAMES), 0.1)
    both = chosen_rolls(np.concatenate([angle, still[0]], axis=1), np.concatenate([misfit, still[1]], axis=1), REFERENCE)
    np.testing.assert_array_equal(both[:, :1], chosen_rolls(angle, misfit, REFERENCE))
    assert (both[:, 1] == -1).all()
    back = chosen_rolls(angle[::-1], misfit[::-1], FRAMES - 1 - REFERENCE)
    np.testing.assert_array_equal(back[::-1], both[:, :1])


def test_a_body_without_limbs_and_one_frame_alone_are_served():
    assert chosen_rolls(np.zeros((FRAMES, 0, TURNS)), np.zeros((FRAMES, 0, TURNS)), REFERENCE).shape == (FRAMES, 0)
    assert (chosen_rolls(np.zeros((1, 2, TURNS)), np.ones((1, 2, TURNS)), 0) == -1).all()


def test_in_one_frame_only_limbs_that_are_known_to_roll_take_the_candidate_that_clearly_fits_better():
    angle = np.radians([[0.0, 30.0, 60.0, 90.0, 180.0]] * 4)
    clear = [0.5, 0.4, 0.1, 0.4, 0.5]
    misfit = np.array([clear, clear, [0.5, 0.5, 0.5, 0.5, 0.48], [0.1, 0.3, 0.4, 0.5, 0.5]])
    assert frame_rolls(angle, misfit, np.array([True, False, True, True])).tolist() == [2, -1, -1, -1]
    assert frame_rolls(angle[:0], misfit[:0], np.zeros(0, bool)).tolist() == []


def test_where_a_take_begins_roll_may_change_at_no_cost():
    angle = np.tile(np.radians([0.0, 150.0]), (12, 1, 1))
    misfit = np.where((np.arange(12) < 6)[:, None, None] == (np.arange(2) == 0), 0.5, 0.55)
    assert chosen_rolls(angle, misfit, 0)[:, 0].tolist() == [-1] * 12
    assert chosen_rolls(angle, misfit, 0, begins=(6,))[:, 0].tolist() == [-1] * 6 + [1] * 6
