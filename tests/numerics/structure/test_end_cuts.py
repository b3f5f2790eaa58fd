"""Rings are proposed across the last parts of limbs alone, and away from the joints that are there."""

import numpy as np
from articulated import chain, three_arms

from kinetree.tasks.numerics.structure.end_cuts import EndCutsSettings, end_cuts


def test_rings_lie_at_their_shares_of_the_part() -> None:
    body = chain((0.0,), along=80)
    cuts = list(end_cuts(body.V, body.F, body.area, body.label, body.parents, body.joints))
    assert {cut.part for cut in cuts} == {1}
    levels = [level for level in EndCutsSettings().levels if level * 5.5 > 1.0]
    height = [cut.centre[2] for cut in cuts if cut.radius > 0.9]
    assert np.abs(np.array(height)[:, None] - 5.5 * np.array(levels)).min(axis=1).max() < 0.25
    for cut in cuts:
        z = body.V[cut.own, 2]
        assert z[~cut.far].max() < z[cut.far].min() + 0.3


def test_skin_blends_over_a_radius_about_the_ring() -> None:
    body = chain((0.0,), along=80)
    for cut in end_cuts(body.V, body.F, body.area, body.label, body.parents, body.joints):
        np.testing.assert_array_equal(cut.share >= 0.5, cut.far)
        assert (cut.share[cut.beyond >= cut.radius / 2] == 1.0).all()
        assert (cut.share[cut.beyond <= -cut.radius / 2] == 0.0).all()
        assert ((cut.share > 0.0) & (cut.share < 1.0)).any()
        assert (np.diff(cut.share[np.argsort(cut.beyond)]) >= 0.0).all()


def test_no_ring_is_proposed_at_the_joint_that_is_there() -> None:
    body = chain((0.0,), along=80)
    for cut in end_cuts(body.V, body.F, body.area, body.label, body.parents, body.joints):
        assert np.linalg.norm(cut.centre - body.joints[1]) >= cut.radius


def test_every_end_has_rings_and_no_part_between_has() -> None:
    arms = three_arms()
    assert {cut.part for cut in end_cuts(arms.V, arms.F, arms.area, arms.label, arms.parents, arms.joints)} == {1, 2, 3}
    body = chain((-1.0, 1.0), along=80)
    assert {cut.part for cut in end_cuts(body.V, body.F, body.area, body.label, body.parents, body.joints)} == {2}


def test_pieces_that_are_too_small_are_not_proposed() -> None:
    body = chain((0.0,), along=80)
    wide = EndCutsSettings(least_area=0.45)
    assert not list(end_cuts(body.V, body.F, body.area, body.label, body.parents, body.joints, wide))
