"""A turn that goes on from frame to frame is evidence; noise, a constant bend and few frames are none."""

import numpy as np
import pytest
from limbs import rotation

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.hinged_piece import HingedFit
from kinetree.tasks.numerics.structure.piece_fit import PiecePose
from kinetree.tasks.numerics.structure.ring_evidence import (
    CHANCE,
    agreeing_turn,
    agreement,
    evidence_of_halves,
    going_on,
    held_gain,
    judged_frames,
    next_but_one,
    ring_evidence,
)


def test_judged_frames_follow_each_other_within_a_take() -> None:
    frames, pairs = judged_frames(10, [slice(0, 4), slice(4, 10)], 40)
    assert frames.tolist() == list(range(10))
    assert (np.diff(pairs, axis=1) == 1).all()
    assert [3, 4] not in pairs.tolist()
    frames, pairs = judged_frames(500, None, 40)
    assert len(pairs) == 39
    assert len(frames) <= 52
    assert pairs[0].tolist() == [0, 1]
    assert pairs[-1].tolist() == [498, 499]
    assert len(judged_frames(1, None, 40)[0]) == 0
    assert len(judged_frames(41, [slice(i, i + 1) for i in range(41)], 40)[1]) == 0


@pytest.mark.parametrize(("most", "pairs"), [(12, 12), (40, 39), (41, 42)])
def test_a_further_frame_never_takes_pairs_away(most: int, pairs: int) -> None:
    judged = [judged_frames(count, None, most) for count in range(1, 200)]
    assert [len(found) for _, found in judged] == [min(count, pairs) for count in range(199)]
    assert max(len(frames) for frames, _ in judged) == pairs * 4 / 3


def test_every_take_is_judged_in_as_many_frames_as_one_alone() -> None:
    _, alone = judged_frames(100, None, 40)
    _, pairs = judged_frames(200, [slice(0, 100), slice(100, 200)], 40)
    np.testing.assert_array_equal(pairs, np.concatenate([alone, alone + 100]))


def following(frames: int, beyond: bool = False) -> Ints:
    """(pair, 2) frames that follow each other; with those that have one between them too."""
    _, pairs = judged_frames(frames, None, frames)
    return np.concatenate([pairs, next_but_one(pairs)]) if beyond else pairs


def agrees(turns: Floats, beyond: bool = False) -> float:
    pairs = following(len(turns), beyond)
    return agreement(pairs, *turns[pairs.T])


def test_slow_turns_agree() -> None:
    slow = np.stack([np.sin(np.arange(40) / 5), np.zeros(40), np.zeros(40)], axis=1)
    assert agrees(slow) == pytest.approx(0.98 - CHANCE / np.sqrt(39), abs=0.02)
    assert agrees(0 * slow) == 0.0
    assert agreeing_turn(slow[:-1], slow[1:]) == pytest.approx(np.degrees(np.std(slow[:, 0])), rel=0.03)
    assert agreeing_turn(slow, -slow) == 0.0


@pytest.mark.parametrize("beyond", [False, True])
@pytest.mark.parametrize("axes", [(1.0, 1.0, 1.0), (1.0, 0.3, 0.3), (1.0, 0.0, 0.0)])
@pytest.mark.parametrize("frames", [9, 18, 36])
def test_noise_agrees_by_chance_in_one_of_six_at_most(frames: int, axes: tuple[float, ...], beyond: bool) -> None:
    turns = np.random.default_rng(1).normal(size=(600, frames, 3)) * np.array(axes)
    turns -= turns.mean(axis=1, keepdims=True)
    assert np.mean([agrees(w, beyond) > 0.0 for w in turns]) < 1 / 6


def test_a_hinge_agrees_amid_noise_about_the_other_axes() -> None:
    slow, rng = 0.1 * np.sin(np.arange(24) / 4), np.random.default_rng(3)
    noise = np.stack([rng.normal(size=(24, 3)) * np.array([0.0, 0.1, 0.1]) for _ in range(50)])
    hinge = slow[:, None] * np.array([1.0, 0.0, 0.0])
    assert np.median([agrees(hinge + n) for n in noise]) > 0.4
    assert np.mean([agrees(n) > 0.0 for n in noise]) < 1 / 6


def test_no_frame_decides_alone() -> None:
    rng = np.random.default_rng(4)
    turns = rng.normal(0.0, 0.03, (20, 40, 3))
    turns[:, 20:22, 0] += 0.4
    assert max(agrees(w) for w in turns) < 0.1
    turns[:, 22:26, 0] += 0.4
    assert min(agrees(w) for w in turns) > 0.35


def test_frames_with_one_between_them_follow_within_a_take() -> None:
    _, pairs = judged_frames(7, [slice(0, 4), slice(4, 7)], 40)
    assert next_but_one(pairs).tolist() == [[0, 2], [1, 3], [4, 6]]
    assert next_but_one(pairs[:1]).shape == (0, 2)


def test_what_a_held_hinge_loses() -> None:
    assert held_gain(np.array([3.0, 5.0]), np.array([1.0, 1.0])) == pytest.approx(1.0)
    assert held_gain(np.array([1.0]), np.array([2.0])) == 0.0


def test_a_turn_that_goes_on_for_one_frame_alone_is_none() -> None:
    """A fit that begins where the one before it ended carries its error on."""
    noise = np.random.default_rng(5).normal(0.0, 0.2, 41)
    turn = [rotation((1.0, 0.0, 0.0), a) for a in noise[1:] + noise[:-1]]
    slow = [rotation((1.0, 0.0, 0.0), 0.3 * np.sin(f / 3)) for f in range(40)]
    above, (_, pairs) = np.tile(np.eye(3), (40, 1, 1)), judged_frames(40, None, 40)
    shown, known = (
        ring_evidence(above, {f: HingedFit(4.0, 1.0, PiecePose(np.eye(3), np.zeros(3), Q)) for f, Q in enumerate(turns)},
                      dict.fromkeys(range(40), 4.0), pairs).score
        for turns in (turn, slow)
    )  # fmt: skip
    assert shown < 0.12
    assert known > 0.6


def test_a_hinge_that_does_no_better_than_held_shows_nothing() -> None:
    turn = [rotation((1.0, 0.0, 0.0), 0.3 * np.sin(f / 3)) for f in range(20)]
    fits = {f: HingedFit(4.0, 1.0, PiecePose(np.eye(3), np.zeros(3), turn[f])) for f in range(20)}
    above, (_, pairs) = np.tile(np.eye(3), (20, 1, 1)), judged_frames(20, None, 40)
    told = [ring_evidence(above, fits, dict.fromkeys(fits, held), pairs) for held in (1.0, 4.0)]
    assert told[0].score == 0.0
    assert told[1].score > 0.5
    assert told[0].gain == told[1].gain == 4.0
    assert told[1].near == 0.0
    assert told[1].far == pytest.approx(np.degrees(0.3 / np.sqrt(2)), rel=0.1)
    assert ring_evidence(above, {f: fits[f] for f in range(3)}, dict.fromkeys(fits, 4.0), pairs).score == 0.0


def test_halves_that_turn_alike_are_evidence_however_the_turn_goes_on() -> None:
    angle, other = np.random.default_rng(2).normal(0.0, 0.3, (2, 40))
    turn, odd = ([rotation((1.0, 0.0, 0.0), a) for a in angles] for angles in (angle, other))
    fits = {f: HingedFit(4.0, 1.0, PiecePose(turn[f], np.zeros(3), turn[f])) for f in range(40)}
    (_, pairs), held, above = judged_frames(40, None, 40), dict.fromkeys(fits, 4.0), np.tile(np.eye(3), (40, 1, 1))
    shown = ring_evidence(above, fits, held, pairs)
    assert shown.score < 0.1
    alike, unlike = ({f: (turn[f], second[f]) for f in reversed(range(40))} for second in (turn, odd))
    found = evidence_of_halves(shown, above, fits, held, alike)
    assert found.score == pytest.approx(1.0 - CHANCE / np.sqrt(40), abs=1e-9)
    assert found.near == pytest.approx(found.far)
    assert found.far == pytest.approx(np.degrees(np.std(angle)), rel=0.01)
    assert found.gain == shown.gain
    assert evidence_of_halves(shown, above, fits, held, unlike).score < 0.1
    assert evidence_of_halves(shown, above, fits, dict.fromkeys(fits, 1.0), alike).score == 0.0


def test_slow_turns_go_on_and_turns_to_and_fro_do_not() -> None:
    def about(angles: Floats) -> Floats:
        return np.stack([rotation((1.0, 0.0, 0.0), a) for a in angles])

    def of(*turns: Floats) -> float:
        """Of a chain whose root turns to and fro about another axis."""
        root = np.stack([rotation((0.0, 1.0, 0.0), (-1.0) ** f) for f in range(40)])
        R = [root]
        for turn in turns:
            R.append(R[-1] @ turn)
        return going_on(np.stack(R, axis=1), np.arange(len(R)) - 1, pairs, 4.0)

    frames, (_, pairs) = np.arange(40), judged_frames(40, None, 40)
    slow, fro, still = about(np.sin(frames / 5)), about(0.5 * (-1.0) ** frames), about(0.01 * (-1.0) ** frames)
    assert of(slow, slow, fro) == pytest.approx(0.98, abs=0.02)
    assert of(slow, fro, fro) == pytest.approx(-1.0)
    assert of(slow, still, still) > 0.9
    assert of(still) == of() == 1.0
    star = np.stack([np.tile(np.eye(3), (40, 1, 1)), fro, slow, slow], axis=1)
    assert going_on(star, np.array([-1, 0, 0, 0]), pairs, 4.0) == pytest.approx(0.98, abs=0.02)
    _, pairs = judged_frames(40, [slice(k, k + 2) for k in range(0, 40, 2)], 40)
    assert of(about((-1.0) ** (frames // 2))) == pytest.approx(1.0)
