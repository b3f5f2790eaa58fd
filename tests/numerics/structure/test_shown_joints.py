"""The frames' surfaces are asked for joints until they show no other, and anew without one midway between two."""

from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pytest
from articulated import Known, swings
from smeared import END, Frames, turning
from trunk import LIMBS, trunk, trunk_with_joint_midway, trunk_with_two_joints, two_pairs, with_joint_amid
from whole_tree import fits_of_rings

from kinetree.tasks.numerics.structure import shown_joints as numerics
from kinetree.tasks.numerics.structure.end_joints import EndJointsSettings
from kinetree.tasks.numerics.structure.evident_rings import EvidentRingsSettings
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_partners import RootedParts, joints_between_pairs
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import MIDWAY, Dropped
from kinetree.tasks.numerics.structure.shown_joints import with_end_joints
from kinetree.tasks.numerics.structure.skinning import skinning
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence
from kinetree.tasks.numerics.structure.without_joint import without_joint


def test_a_trunk_that_bends_at_two_places_is_three() -> None:
    """Each of its pieces is asked again once it is divided."""
    body, after = of_bent_trunk((-1.6, 1.1))
    assert len(after.shown) == 2
    new = list(after.shown)
    np.testing.assert_allclose(np.sort(after.rest[new, 2]), [-1.6, 1.1], atol=0.6)
    z = [body.V[after.label == part, 2].mean() for part in range(len(after.parents))]
    upwards = np.argsort(z)
    chain = [part for part in upwards.tolist() if part not in after.place[2:4]]
    assert {frozenset((k, int(after.parents[k]))) for k in chain if after.parents[k] in chain} == {
        frozenset(pair) for pair in pairwise(chain)
    }
    low = after.parents[after.place[2:4]]
    assert {*low.tolist()} == {chain[0]}
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)
    assert after.end_x.shape == (24, int(after.at_ends.sum()), 3)


def test_vertices_beside_both_joints_lie_on_the_frames() -> None:
    hidden = (-1.6, 1.1)
    body, after = of_bent_trunk(hidden)
    true, z, x = Frames(bending(hidden), heights=(*hidden, END)).true, body.V[:, 2], after.with_ends(body).x
    for part, (low, high) in enumerate(((LIMBS + 0.3, -2.3), (-0.9, 0.4), (1.8, END - 0.7))):
        own = (z > low) & (z < high)
        want = np.einsum("txy,vy->tvx", true.R[:, part], body.V[own]) + true.t[:, None, part]
        assert np.linalg.norm((x[:, own] - want).mean(axis=1), axis=1).max() < 0.08


def test_all_of_the_trunk_is_asked_once_more_and_then_what_is_divided_and_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, list[int]]] = []
    apart: list[float] = []
    whole, judged = numerics.closer_rings, numerics.end_joints
    monkeypatch.setattr(numerics, "closer_rings", lambda *of: asked.append((len(of[3].parents), sorted(of[5]))) or whole(*of))
    monkeypatch.setattr(numerics, "end_joints", lambda *of: apart.append(of[4].evident.least_apart) or judged(*of))
    _, after = of_bent_trunk((-1.6, 1.1))
    assert [count for count, _ in asked] == [5, 6]
    assert asked[0][1] == [0, 1, 2, 3, 4]
    assert apart == [EvidentRingsSettings().least_apart, *2 * [EvidentRingsSettings().least_apart_if_closer]]
    assert set(after.shown) <= set(asked[1][1])
    tree = after._replace(parents=np.array([-1, 0, 1, 2, 3, 4]))
    assert numerics._with_neighbours(tree, np.array([2, 3])) == {1, 2, 3, 4}
    assert numerics._with_neighbours(tree, np.array([0])) == {0, 1}


def test_joint_that_the_first_rings_miss_is_shown_by_closer_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numerics, "all_end_rings", lambda *of: [])
    _, after = of_bent_trunk((0.0,), first_rings=False)
    (new,) = after.shown
    np.testing.assert_allclose(after.rest[new], 0.0, atol=0.4)


def test_pieces_of_a_trunk_that_bends_at_one_place_stay_one() -> None:
    assert len(of_bent_trunk((0.0,))[1].shown) == 1


@pytest.mark.parametrize(("joints", "is_divided"), [(0, False), (1, False), (2, True), (3, True)])
def test_a_trunk_with_two_joints_must_show_more(joints: int, is_divided: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = trunk(bending((0.0,)))
    monkeypatch.setattr(numerics, "joints_between_pairs", lambda *of: np.arange(joints))
    usual, found = EndJointsSettings(), numerics._settings(tree, two_pairs(body))
    more = usual.evident._replace(least_score_in_trunk=usual.evident.least_score_if_divided)
    assert found == (usual._replace(evident=more) if is_divided else usual)


def test_what_a_trunk_must_show_is_asked_anew_once_it_is_divided(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = EndJointsSettings()
    much = usual._replace(evident=usual.evident._replace(least_score_in_trunk=9.0))
    for divided, count in ((usual, 2), (much, 1)):
        asked: list[int] = []
        monkeypatch.setattr(
            numerics,
            "_settings",
            lambda tree, _, asked=asked, divided=divided: (
                asked.append(len(tree.parents)) or (divided if len(tree.parents) > 4 else usual)
            ),
        )
        assert len(of_bent_trunk((-1.6, 1.1))[1].shown) == count
        assert {*asked} == {*range(4, 5 + count)}


@pytest.mark.parametrize(
    ("shown", "settles", "joints"), [((2,), True, [1, 2]), ((2,), False, [1, 2]), ((3,), True, []), ((), True, [])]
)
def test_where_a_joint_is_shown_amid_two_these_go_to_their_bends_and_it_must_lie_far_from_both(
    shown: tuple[int, ...], settles: bool, joints: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    body, two = trunk_with_two_joints(bending((-1.0, 1.0)), (-1.0, 1.0), (-1.0, 1.0))
    extended, settled, after = (
        with_joint_amid(two, shown),
        two._replace(rest=1.1 * two.rest),
        two._replace(drift=two.drift + 1.0),
    )
    asked: list[Any] = []
    evidence: Any = None

    def at_bends(_body: Any, _tree: Any, joints: list[int], _evidence: Any, *, are_needed: bool) -> FirstTree | None:
        assert not are_needed
        asked.extend(joints)
        return settled if settles else None

    def with_shown(_body: Any, tree: FirstTree, *of: Any, roomy: bool) -> FirstTree:
        assert tree is settled
        assert roomy
        return after

    monkeypatch.setattr(numerics, "with_joints_at_bends", at_bends)
    monkeypatch.setattr(numerics, "_with_shown_joints", with_shown)
    found = numerics._with_settled_trunk(body, two, extended, numerics.KnownFits({}), two_pairs(body), evidence)
    assert found[0] is (settled if joints and settles else two)
    assert found[1] is (after if joints and settles else extended)
    assert asked == joints


@pytest.mark.parametrize("one_goes", [False, True])
def test_halves_of_the_frames_may_agree_less_where_no_close_joint_goes(one_goes: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    body, two = trunk_with_two_joints(bending((-1.0, 1.0)), (-1.0, 1.0), (-1.0, 1.0))
    extended, fewer = with_joint_amid(two, (2,)), two._replace(drift=two.drift + 1.0)
    asked: list[dict[str, bool]] = []
    monkeypatch.setattr(numerics, "limb_pairs", lambda *of: two_pairs(body))
    for kept in ("without_inertial_joints", "without_smeared_ends"):
        monkeypatch.setattr(numerics, kept, lambda _body, tree, *of: tree)
    monkeypatch.setattr(numerics, "all_end_rings", lambda *of: [])
    monkeypatch.setattr(numerics, "_with_shown_joints", lambda *of: extended)
    monkeypatch.setattr(numerics, "_without_close_joints", lambda *of: fewer if one_goes else extended)
    monkeypatch.setattr(numerics, "_with_settled_trunk", lambda *of, **how: asked.append(how) or of[1:3])
    evidence: Any = None
    found = with_end_joints(body, two, np.zeros(0, np.int64), [], evidence, np.ones(body.x.shape[:2]), 0.002)
    assert found is (fewer if one_goes else extended)
    assert asked == [{}, *([] if one_goes else [{"are_needed": True}])]


def test_a_trunk_with_one_joint_does_not_settle(monkeypatch: pytest.MonkeyPatch) -> None:
    """It may lie midway between two, and would go to one of them."""
    body, two = trunk_with_two_joints(bending((-1.0, 1.0)), (-1.0, 1.0), (-1.0, 1.0))
    _, one = trunk_with_joint_midway(bending((-1.0, 1.0)), (-1.0, 1.0))
    extended, evidence = with_joint_amid(two, (2,)), None
    monkeypatch.setattr(numerics, "with_joints_at_bends", lambda *of: pytest.fail("it is asked"))
    found = numerics._with_settled_trunk(body, one, extended, numerics.KnownFits({}), two_pairs(body), evidence)
    assert found[0] is one
    assert found[1] is extended


def bending(hidden: tuple[float, ...]) -> np.ndarray:
    """(frame, part, 3, 3) every hidden joint swings by itself; the last part too."""
    turn = swings(24, len(hidden) + 2, 20.0, axes=1, seed=1)
    turn[:, -1] = turning()[:, 2]
    return turn


def of_bent_trunk(hidden: tuple[float, ...], first_rings: bool = True) -> tuple[MovingSurface, FirstTree]:
    """The trunk, and its tree with what the frames show."""
    turn = bending(hidden)
    body, tree = trunk(turn, hidden=hidden)
    smeared, own = body.x.copy(), tree.label == 0
    smeared[:, own] = np.einsum("txy,vy->tvx", tree.R[:, 0], body.V[own]) + tree.t[:, None, 0]
    body = body._replace(x=smeared)
    ones, surface = np.ones(body.x.shape[:2]), cache(Frames(turn, 0.02, heights=(*hidden, END)).prepared(body.size))
    fits = fits_of_rings(body, tree, ones, surface) if first_rings else []
    leaves = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    return body, with_end_joints(body, tree, leaves, fits, surface, ones, 0.002)


class Midway(NamedTuple):
    """A trunk whose two parts move as one each, though it bends at other heights than where they meet, at 0.

    body   : as it was aligned
    before : its tree
    after  : with what the frames show
    true   : the body in the frames
    """

    body: MovingSurface
    before: FirstTree
    after: FirstTree
    true: Known


FAR = EndJointsSettings(EvidentRingsSettings(least_apart=1.5, least_apart_if_closer=1.5))
"""A tube of radius 1 bends over one radius, so that joints 1.1 from the one at 0 count as near it here."""


def of_joint_midway(
    monkeypatch: pytest.MonkeyPatch,
    *hidden: float,
    settings: EndJointsSettings = FAR,
    pairs: slice = slice(None),
    astray: tuple[int, float] | None = None,
) -> Midway:
    """Pairs of limbs that are known; astray: a frame in which half of the lower part is uncertain, and lies so far off."""
    turn = bending(hidden)
    body, tree = trunk_with_joint_midway(turn, hidden)
    known = LimbPairs(*(a[pairs] for a in two_pairs(body)))
    monkeypatch.setattr(numerics, "limb_pairs", lambda *of: known)
    monkeypatch.setattr(numerics, "EndJointsSettings", lambda: settings)
    smeared, confidence = body.x.copy(), np.ones(body.x.shape[:2])
    for part in (0, 1):
        own = tree.label == part
        smeared[:, own] = np.einsum("txy,vy->tvx", tree.R[:, part], body.V[own]) + tree.t[:, None, part]
    if astray is not None:
        frame, far = astray
        half = (tree.label == 0) & (body.V[:, 0] > 0.0)
        smeared[frame, half] += far
        confidence[frame, half] = 0.0
    body, frames = body._replace(x=smeared), Frames(turn, 0.02, heights=(*hidden, END))
    surface = cache(frames.prepared(body.size))
    fits = fits_of_rings(body, tree, confidence, surface, (2, 3, 4, 5))
    after = with_end_joints(body, tree, np.zeros(0, np.int64), fits, surface, confidence, 0.002)
    return Midway(body, tree, after, frames.true)


def test_a_single_joint_midway_between_two_gives_way_to_both(monkeypatch: pytest.MonkeyPatch) -> None:
    body, before, after, _ = of_joint_midway(monkeypatch, -1.1, 1.1)
    assert after.graph.dropped == (Dropped(1, MIDWAY),)
    np.testing.assert_allclose(np.sort(after.rest[list(after.shown), 2]), [-1.1, 1.1], atol=0.4)
    assert len(after.parents) == len(before.parents) + 1
    between = joints_between_pairs(RootedParts(after.label, after.parents, after.radius), two_pairs(body))
    assert sorted(between.tolist()) == sorted(after.shown)


def test_limbs_keep_their_joints_where_a_trunk_is_divided(monkeypatch: pytest.MonkeyPatch) -> None:
    _, before, after, _ = of_joint_midway(monkeypatch, -1.1, 1.1)
    np.testing.assert_array_equal(after.rest[after.place[2:]], before.rest[2:])
    np.testing.assert_array_equal(after.radius[after.place[2:]], before.radius[2:])
    low, high = after.parents[after.place[[2, 4]]]
    assert after.parents[after.place[2:]].tolist() == [low, low, high, high, high]


def test_ends_of_a_divided_trunk_move_as_aligned_and_its_middle_as_the_frames_show(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    body, _, after, true = of_joint_midway(monkeypatch, -1.1, 1.1)
    x, z = after.with_ends(body).x, body.V[:, 2]
    low, high = after.parents[after.place[[2, 4]]]
    (middle,) = set(range(len(after.parents))) - {low, high, *after.place[2:].tolist()}
    for end, inside in ((low, z < -2.2), (high, z > 2.0)):
        own = (after.label == end) & inside
        np.testing.assert_allclose(x[:, own], body.x[:, own], atol=0.05)
        as_part = np.einsum("txy,vy->tvx", after.R[:, end], body.V[own]) + after.t[:, None, end]
        assert np.sqrt(((as_part - body.x[:, own]) ** 2).sum(axis=2).mean()) < 0.05
    own = (after.label == middle) & (np.abs(z) < 0.3)
    want = np.einsum("txy,vy->tvx", true.R[:, 1], body.V[own]) + true.t[:, None, 1]
    off, aligned = (np.linalg.norm((a[:, own] - want).mean(axis=1), axis=1).max() for a in (x, body.x))
    assert off < 0.75 * aligned


def test_what_is_known_of_a_divided_trunk_fits_together(monkeypatch: pytest.MonkeyPatch) -> None:
    body, _, after, _ = of_joint_midway(monkeypatch, -1.1, 1.1)
    np.testing.assert_allclose(after.drift[1:], after.drift_at(after.rest)[1:], rtol=1e-6)
    W = skinning(
        body.V, body.F, after.with_ends(body).x, after.label, after.R, after.t, after.parents, np.ones(body.x.shape[:2]), 0.002
    )
    np.testing.assert_allclose(after.W, W)
    assert after.unexplained.min() > 0.005, "aligned vertices are rigid there, the frames' noise is 0.02"


def test_an_end_of_the_trunk_whose_limb_was_cut_off_stays_as_the_frames_show_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The alignment does not tell the two apart."""
    body, _, after, _ = of_joint_midway(monkeypatch, -1.1, 1.1)
    limb, (low, high) = int(after.place[2]), after.parents[after.place[[2, 4]]]
    t = after.t.copy()
    t[:, [low, high]] += 0.3
    off = after._replace(t=t, shown=tuple(sorted((*after.shown, limb))))
    off = off._replace(end_x=after.with_ends(body).x[:, off.at_ends])
    evidence = SurfaceEvidence(Frames(turning()).prepared(body.size), np.ones(body.x.shape[:2]), 0.002)
    found = numerics._with_ends_of_trunk_as_aligned(body, off, np.array(after.shown), evidence)
    np.testing.assert_array_equal(found.t[:, low], off.t[:, low])
    np.testing.assert_allclose(found.t[:, high], after.t[:, high], atol=0.05)


def test_uncertain_vertices_do_not_move_the_ends_of_a_divided_trunk(monkeypatch: pytest.MonkeyPatch) -> None:
    certain, spoilt = (of_joint_midway(monkeypatch, -1.1, 1.1, astray=astray).after for astray in (None, (5, 3.0)))
    assert spoilt.graph.dropped == certain.graph.dropped
    low = [int(tree.parents[tree.place[2]]) for tree in (certain, spoilt)]
    t = [tree.t[5, part] + tree.R[5, part] @ [0.0, 0.0, LIMBS] for tree, part in zip((certain, spoilt), low, strict=True)]
    assert np.linalg.norm(t[0] - t[1]) < 0.3


def test_a_single_joint_that_lies_right_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    _, before, after, _ = of_joint_midway(monkeypatch, 0.0)
    assert (after.parents.tolist(), after.shown, after.graph.dropped) == (before.parents.tolist(), (), ())
    np.testing.assert_array_equal(after.rest, before.rest)


def test_a_joint_beside_which_another_shows_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the limits that are used: the frames show one at 1.6, and the one at 0 is right."""
    _, before, after, _ = of_joint_midway(monkeypatch, 0.0, 1.6, settings=EndJointsSettings())
    assert (len(after.shown), after.graph.dropped) == (1, ())
    np.testing.assert_array_equal(after.rest[after.place[1]], before.rest[1])


def test_no_joint_gives_way_where_another_one_would_go_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, asked = numerics._with_shown_joints, list[FirstTree]()

    def with_one_fewer_when_divided(body: MovingSurface, tree: FirstTree, *rest: Any) -> FirstTree:
        asked.append(tree)
        return whole(body, tree, *rest) if len(asked) == 1 else without(body, tree, len(tree.parents) - 1)

    monkeypatch.setattr(numerics, "_with_shown_joints", with_one_fewer_when_divided)
    _, before, after, _ = of_joint_midway(monkeypatch, -1.1, 1.1)
    assert len(asked) == 2
    assert len(asked[1].parents) == len(before.parents) + 1, "both joints showed"
    assert (after.parents.tolist(), after.graph.dropped) == (before.parents.tolist(), ())


def test_a_joint_that_the_frames_alone_show_is_not_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cut has none between the pairs of limbs."""
    turn = bending((0.0,))
    body, tree = trunk_with_joint_midway(turn, (0.0,))
    one, ones = without(body, tree, 1), np.ones(body.x.shape[:2])
    smeared = body.x.copy()
    own = one.label == 0
    smeared[:, own] = np.einsum("txy,vy->tvx", one.R[:, 0], body.V[own]) + one.t[:, None, 0]
    body = body._replace(x=smeared)
    monkeypatch.setattr(numerics, "limb_pairs", lambda *of: two_pairs(body))
    surface = cache(Frames(turn, 0.02).prepared(body.size))
    fits = fits_of_rings(body, one, ones, surface, (1, 2, 3, 4))
    after = with_end_joints(body, one, np.zeros(0, np.int64), fits, surface, ones, 0.002)
    assert (len(after.shown), len(after.graph.dropped)) == (1, 1)


def test_without_two_pairs_of_limbs_no_joint_gives_way(monkeypatch: pytest.MonkeyPatch) -> None:
    _, before, after, _ = of_joint_midway(monkeypatch, -1.1, 1.1, pairs=slice(0, 1))
    assert (after.parents.tolist(), after.graph.dropped) == (before.parents.tolist(), ())


def without(body: MovingSurface, tree: FirstTree, joint: int, confidence: np.ndarray | None = None) -> FirstTree:
    ones = np.ones(body.x.shape[:2])
    evidence = SurfaceEvidence(lambda frame: None, ones if confidence is None else confidence, 0.002)
    return without_joint(body, tree, joint, evidence, MIDWAY)


def test_two_parts_without_their_joint_are_one_that_moves_as_that_above_and_all_else_stays() -> None:
    body, before = trunk_with_joint_midway(bending((0.0,)), (0.0,))
    after = without(body, before, 1)
    assert after.parents.tolist() == [-1, 0, 0, 0, 0, 0]
    np.testing.assert_array_equal(after.label, np.array([0, 0, 1, 2, 3, 4, 5])[before.label])
    assert after.place.tolist() == [0, -1, 1, 2, 3, 4, 5]
    assert after.graph.dropped == (Dropped(1, MIDWAY),)
    others = [0, 2, 3, 4, 5, 6]
    for field in ("R", "t", "unexplained", "certain_share"):
        np.testing.assert_array_equal(getattr(after, field), getattr(before, field)[:, others])
    np.testing.assert_array_equal(after.rest, before.rest[others])
    np.testing.assert_array_equal(after.radius, before.radius[others])
    np.testing.assert_allclose(after.drift[1:], after.drift_at(after.rest)[1:])
    assert (after.drift[3:] > 0.1).all(), "they hang on a part that moves otherwise"


def test_what_moves_otherwise_follows_the_one_part_less() -> None:
    body, before = trunk_with_joint_midway(bending((0.0,)), (0.0,))
    after, z = without(body, before, 1), body.V[:, 2]
    assert after.W[(z > 1.0) & (z < END), 0].mean() < 0.5, "these go with the limbs that hang there"
    like_it = after.W[:, :3].sum(axis=1)  # the limbs below move as it does
    assert like_it[z < -0.5].min() > 0.99


@pytest.mark.parametrize(("joint", "parents"), [(1, [-1, 0, 1]), (2, [-1, 0, 1]), (3, [-1, 0, 1])])
def test_a_chain_is_shorter_by_the_part_that_goes(joint: int, parents: list[int]) -> None:
    body, tree = trunk(bending((0.0,)))
    after = without(body, tree._replace(parents=np.array([-1, 0, 1, 2])), joint)
    assert after.parents.tolist() == parents
    assert after.place.tolist() == [k - (k > joint) if k != joint else -1 for k in range(4)]
