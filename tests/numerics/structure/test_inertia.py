"""A turn against the acceleration of its limb is flesh; another one, a wide one and one in few frames are none."""

import numpy as np
import pytest
from limbs import rotation

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.inertia import MOST, Turns, beyond_inertia, inertial_turns
from kinetree.tasks.numerics.structure.ring_evidence import judged_frames

FRAMES = 36
LONG = np.array([0.0, 0.0, 2.0])


def swing(frames: int = FRAMES) -> tuple[Floats, Floats]:
    """(frame, 3, 3) · (frame, xyz) a limb that swings about the origin by 40° to either side, about x and somewhat about y."""
    angle = np.radians(40.0) * np.sin(2.0 * np.pi * np.arange(frames) / 12.0)
    R = np.array([rotation((1.0, 0.0, 0.0), a) @ rotation((0.0, 1.0, 0.0), 0.4 * a**2) for a in angle])
    return R, np.zeros((frames, 3))


def bent_by_flesh(degrees: float, most: float = np.inf) -> Turns:
    """Turns of the middle of the limb whose flesh stays behind, of such a root mean square; it goes only so far (its mean)."""
    q = np.array(list(inertial_turns(LONG, LONG, *swing()).values()))
    far = np.linalg.norm(q, axis=1, keepdims=True)
    w = q / (1.0 + far / (most * far.mean()))
    w -= w.mean(axis=0)
    w *= np.radians(degrees) / np.sqrt((w**2).sum(axis=1).mean())
    return dict(enumerate(w, start=1))


def own_turns(degrees: float, period: float) -> Turns:
    """Of a hinge about y, slow and not in step with the limb."""
    return {f: np.radians(degrees) * np.sqrt(2.0) * np.array([0.0, np.sin(2 * np.pi * f / period), 0.0]) for f in range(FRAMES)}


def pairs(frames: int = FRAMES) -> Ints:
    return judged_frames(frames, None, frames)[1]


def left(turn: Turns) -> float:
    return beyond_inertia(turn, inertial_turns(LONG, LONG, *swing()), pairs())


def test_flesh_bends_against_the_acceleration_of_its_limb() -> None:
    """A limb along z that speeds up along x: its middle stays behind, so that its end turns towards x, about y."""
    x = np.array([[f**2, 0.0, 0.0] for f in range(5)], np.float64)
    turns = inertial_turns(LONG, LONG, np.tile(np.eye(3), (5, 1, 1)), x)
    assert list(turns) == [1, 2, 3]
    np.testing.assert_allclose(list(turns.values()), [[0.0, 4.0, 0.0]] * 3)


def test_turns_are_told_in_the_axes_of_the_reference() -> None:
    R, x = rotation((1.0, 2.0, 3.0), 1.0), np.array([[f**2, 0.0, 0.0] for f in range(5)], np.float64)
    turns = inertial_turns(LONG, LONG, np.tile(R, (5, 1, 1)), x @ R.T)
    np.testing.assert_allclose(list(turns.values()), [[0.0, 4.0, 0.0]] * 3, atol=1e-12)


def test_a_limb_that_speeds_up_along_itself_does_not_bend() -> None:
    x = np.array([[0.0, 0.0, f**2] for f in range(5)], np.float64)
    np.testing.assert_allclose(list(inertial_turns(LONG, LONG, np.tile(np.eye(3), (5, 1, 1)), x).values()), 0.0)


def test_no_acceleration_leads_from_take_to_take() -> None:
    R, t = swing(10)
    assert list(inertial_turns(LONG, LONG, R, t, [slice(0, 4), slice(4, 10)])) == [1, 2, 5, 6, 7, 8]
    assert inertial_turns(LONG, LONG, R[:1], t[:1]) == {}


@pytest.mark.parametrize("most", [np.inf, 3.0, 1.0, 0.3])
def test_inertia_explains_flesh_however_far_it_goes(most: float) -> None:
    assert left(bent_by_flesh(4.0, most)) < 0.1


@pytest.mark.parametrize("period", [7.0, 17.0, 40.0])
def test_inertia_does_not_explain_a_joint(period: float) -> None:
    assert left(own_turns(4.0, period)) > 0.9


def test_a_turn_towards_the_acceleration_is_no_flesh() -> None:
    assert left({f: -w for f, w in bent_by_flesh(4.0).items()}) == 1.0


def test_what_turns_farther_than_flesh_is_a_joint() -> None:
    assert left(bent_by_flesh(0.9 * MOST)) < 0.1
    assert left(bent_by_flesh(1.2 * MOST)) == 1.0


def test_few_frames_and_no_turn_at_all_say_nothing() -> None:
    flesh, few = bent_by_flesh(4.0), inertial_turns(LONG, LONG, *swing(5))
    assert beyond_inertia(flesh, few, pairs()) == 1.0
    assert beyond_inertia(flesh, {}, pairs()) == 1.0
    assert left({f: 0.0 * w for f, w in flesh.items()}) == 1.0
    assert beyond_inertia(flesh, {f: 0.0 * w for f, w in flesh.items()}, pairs()) == 1.0


def test_what_inertia_explains_of_little_counts_in_part() -> None:
    """Amid noise the little that agrees is in step with the limb by chance, or because flesh is all that agrees."""
    flesh, rng = bent_by_flesh(4.0), np.random.default_rng(0)

    def mean(noise: float) -> float:
        noisy = ({f: w + np.radians(noise) * rng.normal(size=3) for f, w in flesh.items()} for _ in range(80))
        return float(np.mean([left(turn) for turn in noisy]))

    assert mean(0.5) < 0.1
    assert mean(10.0) > 0.93
