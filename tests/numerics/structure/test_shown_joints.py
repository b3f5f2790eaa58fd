"""The frames' surfaces are asked for joints until they show no other, and anew without one midway between two."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from articulated import swings
from shipped import TREE
from smeared import END, Frames, turning
from trunk import LIMBS, trunk, trunk_with_joint_midway, two_pairs
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
    monkeypatch.setattr(
        numerics,
        "end_joints",
        lambda *of, **more: apart.append((more or {"settings": of[5]})["settings"].evident.least_apart) or judged(*of, **more),
    )
    _, after = of_bent_trunk((-1.6, 1.1))
    assert [count for count, _ in asked] == [5, 6]
    assert asked[0][1] == [0, 1, 2, 3, 4]
    assert apart == [EvidentRingsSettings().least_apart, *2 * [EvidentRingsSettings().least_apart_if_closer]]
    assert set(after.shown) <= set(asked[1][1])
    tree = after._replace(parents=np.array([-1, 0, 1, 2, 3, 4]))
    assert numerics._with_neighbours(tree, np.array([2, 3])) == {1, 2, 3, 4}
    assert numerics._with_neighbours(tree, np.array([0])) == {0, 1}


def test_joint_that_the_first_rings_miss_is_shown_by_closer_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numerics, "end_rings", lambda *of: [])
    _, after = of_bent_trunk((0.0,), first_rings=False)
    (new,) = after.shown
    np.testing.assert_allclose(after.rest[new], 0.0, atol=0.4)


def test_pieces_of_a_trunk_that_bends_at_one_place_stay_one() -> None:
    assert len(of_bent_trunk((0.0,))[1].shown) == 1


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
    return body, with_end_joints(body, tree, leaves, fits, surface, ones, settings=TREE)


def of_joint_midway(
    hidden: tuple[float, ...], monkeypatch: pytest.MonkeyPatch, pairs: slice = slice(None)
) -> tuple[MovingSurface, FirstTree, FirstTree]:
    """The body as aligned, where the two parts of a trunk whose joint lies at 0 move as one each; its tree, and with what the
    frames show. Pairs of limbs that are known; rings count that lie farther from joints than others, so that beside the joint
    at 0 none does.
    """
    turn = bending(hidden)
    body, tree = trunk_with_joint_midway(turn, hidden)
    known = LimbPairs(*(a[pairs] for a in two_pairs(body)))
    far = EndJointsSettings(EvidentRingsSettings(least_apart=1.5, least_apart_if_closer=1.5))
    monkeypatch.setattr(numerics, "limb_pairs", lambda *of: known)
    monkeypatch.setattr(numerics, "EndJointsSettings", lambda: far)
    smeared = body.x.copy()
    for part in (0, 1):
        own = tree.label == part
        smeared[:, own] = np.einsum("txy,vy->tvx", tree.R[:, part], body.V[own]) + tree.t[:, None, part]
    body = body._replace(x=smeared)
    ones, surface = np.ones(body.x.shape[:2]), cache(Frames(turn, 0.02, heights=(*hidden, END)).prepared(body.size))
    fits = fits_of_rings(body, tree, ones, surface, (2, 3, 4, 5))
    return body, tree, with_end_joints(body, tree, np.zeros(0, np.int64), fits, surface, ones, settings=TREE)


def test_a_single_joint_midway_between_two_gives_way_to_both(monkeypatch: pytest.MonkeyPatch) -> None:
    body, before, after = of_joint_midway((-1.1, 1.1), monkeypatch)
    assert after.graph.dropped == (Dropped(1, MIDWAY),)
    np.testing.assert_allclose(np.sort(after.rest[list(after.shown), 2]), [-1.1, 1.1], atol=0.5)
    assert len(after.parents) == len(before.parents) + 1
    between = joints_between_pairs(RootedParts(after.label, after.parents, after.radius), two_pairs(body))
    assert sorted(between.tolist()) == sorted(after.shown)


def test_ends_of_a_divided_trunk_move_as_aligned(monkeypatch: pytest.MonkeyPatch) -> None:
    body, _, after = of_joint_midway((-1.1, 1.1), monkeypatch)
    low = int(after.parents[after.place[2]])
    own = after.label == low
    np.testing.assert_array_equal(after.with_ends(body).x[:, own], body.x[:, own])
    off = np.einsum("txy,vy->tvx", after.R[:, low], body.V[own]) + after.t[:, None, low] - body.x[:, own]
    assert np.sqrt((off**2).sum(axis=2).mean()) < 0.05
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)


def test_a_single_joint_that_lies_right_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    _, before, after = of_joint_midway((0.0,), monkeypatch)
    assert (after.parents.tolist(), after.shown, after.graph.dropped) == (before.parents.tolist(), (), ())
    np.testing.assert_array_equal(after.rest, before.rest)


def test_without_two_pairs_of_limbs_no_joint_gives_way(monkeypatch: pytest.MonkeyPatch) -> None:
    _, before, after = of_joint_midway((-1.1, 1.1), monkeypatch, slice(0, 1))
    assert (after.parents.tolist(), after.graph.dropped) == (before.parents.tolist(), ())
