"""Fitting an articulated body."""

import numpy as np
import pytest
from articulated import chain, swings, three_arms
from limbs import rotation

from kinetree.tasks.numerics.structure.articulated_fit import Motion, PosePrior, beyond, fitted, placed, predicted, sums


def lengths(motion: Motion, parents: np.ndarray) -> np.ndarray:
    X = placed(motion, parents)
    return np.linalg.norm(X[:, 1:] - X[:, parents[1:]], axis=2)


def at_rest(joints: np.ndarray, frames: int) -> Motion:
    return Motion(joints, np.broadcast_to(np.eye(3), (frames, len(joints), 3, 3)).copy(), np.zeros((frames, 3)))


def test_poses_of_a_skinned_body_are_found_from_rest() -> None:
    body = chain((-1.5, 1.5), blend=1.0)
    found = fitted(sums(body.V, body.x, body.W, body.parents, body.area), at_rest(body.joints, 24), body.parents, rounds=30)
    assert np.abs(found.R - body.R).max() < 1e-4
    assert predicted(body.V, body.W, found, body.parents) == pytest.approx(body.x, abs=1e-3)


@pytest.mark.parametrize("frames_alike", [True, False], ids=["frames alike", "each frame's own weights"])
def test_a_body_in_metres_is_found_as_well_a_thousand_kilometres_away(frames_alike: bool) -> None:
    body, size, shift = chain((-1.5, 1.5), blend=1.0), 0.1, 1e6 * np.array([0.6, -0.64, 0.48])
    tau = body.area if frames_alike else np.tile(body.area, (24, 1))

    def found(shift: np.ndarray) -> Motion:
        V, x, start = size * body.V + shift, size * body.x + shift, at_rest(size * body.joints + shift, 24)
        return fitted(sums(V, x, body.W, body.parents, tau), start, body.parents, rounds=30)

    here, there = found(np.zeros(3)), found(shift)
    np.testing.assert_allclose(there.R, here.R, atol=1e-6)
    np.testing.assert_allclose(placed(there, body.parents) - shift, placed(here, body.parents), atol=1e-6 * size)


def test_bones_have_one_length_whatever_the_vertices_do() -> None:
    body = three_arms()
    noisy = body.x + np.random.default_rng(1).normal(0, 1.0, body.x.shape)
    found = fitted(sums(body.V, noisy, body.W, body.parents, body.area), at_rest(body.joints, 24), body.parents)
    assert np.ptp(lengths(found, body.parents), axis=0) == pytest.approx(0, abs=1e-9)
    assert placed(found, body.parents) == pytest.approx(
        placed(Motion(body.joints, body.R, body.t[:, 0]), body.parents), abs=0.3
    )


def test_equal_trust_in_all_frames_is_no_trust() -> None:
    body = chain((0.0,), blend=1.0)
    start = at_rest(body.joints, 24)
    one = fitted(sums(body.V, body.x, body.W, body.parents, body.area), start, body.parents)
    other = fitted(sums(body.V, body.x, body.W, body.parents, np.tile(body.area, (24, 1))), start, body.parents)
    assert np.abs(other.R - one.R).max() < 1e-9


def test_sums_are_those_of_every_vertex_in_every_frame() -> None:
    body, rng = three_arms(), np.random.default_rng(2)
    tau, W = rng.random(body.x.shape[:2]), rng.random(body.W.shape) * (body.W > 0)
    found = sums(body.V, body.x, W, body.parents, tau)
    V, x = body.V - found.origin, body.x - found.middle[:, None]
    phi = np.concatenate([(W[:, :, None] * V[:, None]).reshape(len(V), -1), W @ beyond(body.parents).T], axis=1)
    np.testing.assert_allclose(found.G, np.einsum("tv,va,vb->tab", tau, phi, phi, optimize=True), atol=1e-9)
    np.testing.assert_allclose(found.C, np.einsum("tv,tvx,va->txa", tau, x, phi, optimize=True), atol=1e-9)


def test_part_without_evidence_turns_as_expected() -> None:
    body = chain((0.1,), swings(6, 2))
    tau = np.tile(body.area, (6, 1))
    tau[:, body.label == 1] = 1e-9
    turn = np.broadcast_to(np.eye(3), (6, 2, 3, 3)).copy()
    turn[:, 1] = rotation((0.0, 1.0, 0.0), 0.4)
    firm = np.zeros((6, 2))
    firm[:, 1] = 10.0
    found = fitted(
        sums(body.V, body.x, body.W, body.parents, tau), at_rest(body.joints, 6), body.parents, PosePrior(turn, firm), rounds=30
    )
    assert found.R[:, 1] == pytest.approx(turn[:, 1], abs=1e-4)


def test_what_lies_beyond_a_joint() -> None:
    assert beyond(np.array([-1, 0, 1, 0])).tolist() == [[1, 1, 1, 1], [0, 1, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
