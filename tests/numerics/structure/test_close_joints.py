"""A joint of a cut beside one of the trunk that the frames' surfaces show goes if one joint does as well as two."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from articulated import swings
from smeared import END, Frames, turning
from trunk import trunk_with_joint_midway, two_pairs
from whole_tree import fits_of_rings

from kinetree.tasks.numerics.structure import close_joints as numerics
from kinetree.tasks.numerics.structure import shown_joints
from kinetree.tasks.numerics.structure.close_joints import are_as_good, close_joints
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import SMEARED, Dropped
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence
from kinetree.tasks.numerics.structure.without_joint import without_joint

SHOWN = 1.1
"""Height of the joint that surfaces show; the cut has one at 0."""


class Bent(NamedTuple):
    """A trunk as it was aligned, the tree of a cut with a joint at 0, and what the frames show."""

    body: MovingSurface
    tree: FirstTree
    evidence: SurfaceEvidence


@pytest.fixture(autouse=True)
def _these_are_close(monkeypatch: pytest.MonkeyPatch) -> None:
    """The two lie at 1.02 radii: rings across this tube leave a choice of few heights."""
    monkeypatch.setattr(numerics, "CLOSE", 1.3)


@pytest.fixture(scope="module")
def bent_twice() -> Bent:
    return bent(0.0, SHOWN)


@pytest.fixture(scope="module")
def extended(bent_twice: Bent) -> FirstTree:
    """With the joint that surfaces show beside that of the cut; both are true."""
    body, tree, evidence = bent_twice
    fits = fits_of_rings(body, tree, evidence.confidence, evidence.surface, (2, 3, 4, 5))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(shown_joints, "limb_pairs", lambda *of: two_pairs(body))
        return shown_joints.with_end_joints(
            body, tree, np.zeros(0, np.int64), fits, evidence.surface, evidence.confidence, evidence.noise
        )


def bent(*heights: float) -> Bent:
    """The cut's two parts move as one each, wherever the trunk bends."""
    turn = swings(24, len(heights) + 2, 20.0, axes=1, seed=1)
    turn[:, -1] = turning()[:, 2]
    body, tree = trunk_with_joint_midway(turn, heights)
    x = body.x.copy()
    for part in (0, 1):
        own = tree.label == part
        x[:, own] = np.einsum("txy,vy->tvx", tree.R[:, part], body.V[own]) + tree.t[:, None, part]
    surface = cache(Frames(turn, 0.02, heights=(*heights, END)).prepared(body.size))
    return Bent(body._replace(x=x), tree, SurfaceEvidence(surface, np.ones(x.shape[:2]), 0.002))


def without(of: Bent, extended: FirstTree) -> FirstTree:
    return shown_joints._without_close_joints(of.body, of.tree, extended, two_pairs(of.body), of.evidence)


def test_both_stay_where_the_trunk_bends_at_both(bent_twice: Bent, extended: FirstTree) -> None:
    assert len(extended.shown) == 1
    assert abs(extended.rest[extended.shown[0], 2] - SHOWN) < 0.4
    assert len(extended.parents) == len(bent_twice.tree.parents) + 1
    assert close_joints(bent_twice.tree, extended, two_pairs(bent_twice.body)) == [1]
    assert without(bent_twice, extended) is extended


def test_the_cuts_one_goes_where_surfaces_show_the_other_alone(
    bent_twice: Bent, extended: FirstTree, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[FirstTree] = []
    monkeypatch.setattr(shown_joints, "_with_shown_joints", lambda *of: asked.append(of[1]) or single_of(bent_twice, extended))
    after = without(bent_twice, extended)
    (one,) = asked
    assert one.graph.dropped == (Dropped(1, SMEARED),)
    assert one.rest[:, 2].tolist() == np.delete(bent_twice.tree.rest[:, 2], 1).tolist()
    assert len(after.parents) == len(bent_twice.tree.parents)
    assert after.rest[after.shown[0], 2] == extended.rest[extended.shown[0], 2]


@pytest.mark.parametrize(("roomy_too", "goes"), [(False, True), (True, False)])
def test_another_one_in_its_place_must_lie_far_from_the_joints_beside_it(
    roomy_too: bool, goes: bool, bent_twice: Bent, extended: FirstTree, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without the cut's joint the surfaces show one more; asked with rings a radius from others alone, perhaps not."""
    asked: list[bool] = []

    def shown(*of: object, roomy: bool = False) -> FirstTree:
        asked.append(roomy)
        return extended if roomy_too or not roomy else single_of(bent_twice, extended)

    monkeypatch.setattr(shown_joints, "_with_shown_joints", shown)
    after = without(bent_twice, extended)
    assert asked == [False, True]
    assert (after is not extended) == goes
    assert len(after.parents) == len(extended.parents) - goes


def test_it_stays_where_one_joint_does_worse(bent_twice: Bent, extended: FirstTree, monkeypatch: pytest.MonkeyPatch) -> None:
    single = single_of(bent_twice, extended)
    worse = single._replace(unexplained=10.0 * single.unexplained)
    monkeypatch.setattr(shown_joints, "_with_shown_joints", lambda *of: worse)
    assert without(bent_twice, extended) is extended


def single_of(of: Bent, extended: FirstTree) -> FirstTree:
    """The extended tree without the cut's joint."""
    single = without_joint(of.body, extended, int(extended.place[1]), of.evidence, SMEARED)
    return single._replace(shown=(extended.shown[0] - 1,))


def test_joints_that_are_asked_for(bent_twice: Bent, extended: FirstTree, monkeypatch: pytest.MonkeyPatch) -> None:
    tree, pairs, (shown,) = bent_twice.tree, two_pairs(bent_twice.body), extended.shown
    rest, low = extended.rest.copy(), int(extended.place[1])
    rest[low, 2] = rest[shown, 2] - 1.01 * numerics.CLOSE * extended.radius[[low, shown]].min()
    assert close_joints(tree, extended._replace(rest=rest), pairs) == []
    apart = extended._replace(parents=np.where(np.arange(len(rest)) == shown, 2, extended.parents))
    assert close_joints(tree, apart, pairs) == [], "the two share no part"
    at_end = extended._replace(shown=(int(extended.place[6]),))
    assert close_joints(tree, at_end, pairs) == [], "no joint of the trunk is shown"
    monkeypatch.setattr(numerics, "of_mirrored_limbs", lambda tree, _: np.ones(len(tree.parents), np.bool_))
    assert close_joints(tree, extended, pairs) == [], "it is of a limb with a mirror image"


def test_the_closest_is_asked_for_first(bent_twice: Bent, extended: FirstTree) -> None:
    rest, radius = extended.rest.copy(), extended.radius.copy()
    head, shown = int(extended.place[6]), extended.shown[0]
    radius[head] = 1.0
    for away, order in ((0.5, [6, 1]), (1.2, [1, 6])):
        rest[head] = rest[shown] + [0.0, 0.0, away]
        found = close_joints(bent_twice.tree, extended._replace(rest=rest, radius=radius), two_pairs(bent_twice.body))
        assert found == order


def test_one_does_as_well_if_the_trunk_is_explained_and_no_other_joint_goes(bent_twice: Bent, extended: FirstTree) -> None:
    (area, pairs), shown = (bent_twice.body.area, two_pairs(bent_twice.body)), extended.shown
    assert are_as_good(area, extended, extended, pairs)
    limbs = [int(extended.place[k]) for k in (2, 3, 4, 5)]
    for factor, parts, good in ((0.99, slice(None), True), (1.01, slice(None), False), (9.0, limbs, True)):
        left = extended.unexplained.copy()
        left[:, parts] *= factor * numerics.AS_WELL
        assert are_as_good(area, extended, extended._replace(unexplained=left), pairs) == good
    for factor, good in ((0.99, True), (1.01, False)):
        left = factor * numerics.AS_WELL_WITH_FEWER * extended.unexplained
        assert are_as_good(area, extended, extended._replace(shown=(), unexplained=left), pairs) == good
        drift = factor * numerics.DRIFT_WITH_FEWER * (extended.drift + 0.01)
        before = extended._replace(drift=extended.drift + 0.01)
        assert are_as_good(area, before, extended._replace(shown=(), drift=drift), pairs) == good
    end = int(extended.place[6])
    more = extended._replace(shown=(*shown, end))
    assert are_as_good(area, extended, more, pairs)
    assert not are_as_good(area, more, extended, pairs), "a joint at an end goes"
