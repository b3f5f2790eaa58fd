"""Parts lie on the frames' own surfaces, from wherever they were aligned."""

import numpy as np
from smeared import Frames, three_parts, turning

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.laid_parts import NOTHING_LAID, LaidPartsSettings, laid_parts, within_limbs


def test_parts_lie_where_the_frames_have_them_and_not_where_they_were_aligned() -> None:
    body, found = three_parts()
    off = found._replace(t=found.t + np.array([0.02, 0.0, 0.0]) * body.size)
    true = Frames(turning()).true
    laid = laid_parts(body, off, Frames(turning()).prepared(body.size))
    assert laid.joint.tolist() == [0, 1, 2]
    middle = np.stack([body.V[found.label == part].mean(axis=0) for part in laid.joint])
    there = np.einsum("flxy,ly->flx", laid.rotation, middle) + laid.translation
    want = np.einsum("flxy,ly->flx", true.R, middle) + true.t
    away = np.linalg.norm(there - want, axis=2)
    # a tube is free to slide along itself
    assert np.median(away) < 0.02 * body.size / 2
    assert (laid.square < (0.002 * body.size) ** 2).all()


def test_stiffness_is_that_of_a_turn_and_a_shift() -> None:
    body, found = three_parts()
    laid = laid_parts(body, found, Frames(turning()).prepared(body.size))
    assert laid.stiffness.shape == (24, 3, 6, 6)
    np.testing.assert_allclose(laid.stiffness, laid.stiffness.swapaxes(2, 3), atol=1e-9)
    assert (np.linalg.eigvalsh(laid.stiffness) > -1e-9).all()


def test_parts_within_limbs_are_those_without_a_branch_above_them() -> None:
    assert within_limbs(np.array([-1, 0, 1, 2, 0, 4, 4])).tolist() == [False, False, True, True, False, False, False]


def test_of_many_frames_some_are_looked_at_and_of_few_none() -> None:
    body, found = three_parts()
    asked = []

    def shown(frame: int) -> Target:
        asked.append(frame)
        return Frames(turning()).prepared(body.size)(frame)

    assert laid_parts(body, found, shown, LaidPartsSettings(most_frames=12)).frame.tolist() == asked
    assert (len(asked), asked[0], asked[-1]) == (12, 0, 23)
    assert laid_parts(body, found, shown, LaidPartsSettings(most_frames=7)) is NOTHING_LAID
