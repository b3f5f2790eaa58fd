"""The rigid parts as the task gives them."""

import numpy as np
from aligned_body import FIRST, task_inputs
from articulated import three_arms

from kinetree.schemas.structure.rigid_parts import CutParams, RigidParts
from kinetree.tasks.structure.rigid_parts import rigid_parts


def parts_of(V: np.ndarray, F: np.ndarray, x: np.ndarray, **params: float) -> RigidParts:
    return rigid_parts(*task_inputs(V, F, x), CutParams(**params))


def test_arms_that_turn_are_parts_and_carry_their_vertices() -> None:
    body = three_arms()
    found = parts_of(body.V, body.F, body.x)
    assert (found.frames[0], len(found.frames)) == (FIRST, len(body.x))
    for arm in (1, 2, 3):
        far = body.label == arm
        assert (found.label[far] == np.bincount(found.label[far]).argmax()).mean() > 0.9
    carried = np.einsum("fvij,vj->fvi", found.rotation[:, found.label], body.V) + found.translation[:, found.label]
    sure = found.rigid > 0.99
    assert sure.mean() > 0.5
    assert np.linalg.norm(carried - body.x, axis=2)[:, sure].max() < 0.02 * np.ptp(body.V)
    assert found.residual.shape == found.rotation.shape[:2]


def test_how_parts_were_cut_and_eliminated_is_stored_with_them() -> None:
    body = three_arms()
    found = parts_of(body.V, body.F, body.x, rings=20)
    assert found.run.shape == found.merge.shape == (len(found.tip), 20)
    assert found.initial.max() + 1 >= len(found.origin) == found.rotation.shape[1]
    assert len(found.removed) == len(found.cost)
    assert (found.cost < found.cost_threshold).all()
    assert found.merge_threshold == 0.002


def test_a_stiff_sequence_is_one_part() -> None:
    body = three_arms()
    found = parts_of(body.V, body.F, np.stack([body.V + f for f in range(5)]))
    assert found.rotation.shape[1] == 1
    assert (found.label == 0).all()


def test_a_bar_out_of_reach_leaves_one_part() -> None:
    body = three_arms()
    assert parts_of(body.V, body.F, body.x, removal_cost=10.0).rotation.shape[1] == 1
