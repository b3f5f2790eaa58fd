"""Bones that no skin shows become parts where their length shows them."""

from typing import Any

import numpy as np
import pytest
from articulated import ALL_STAY, Known, and_at_rest, chain, moved, neck, neck_ends, surface, swings
from shapes import y_pipe

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure import linked_parts
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.hidden_bones import HiddenBonesSettings
from kinetree.tasks.numerics.structure.joint_consensus import JointConsensus
from kinetree.tasks.numerics.structure.linked_parts import LinkedPartsSettings, LinkedTree, with_rigid_links
from kinetree.tasks.numerics.structure.rigid_links import Between, RigidLink, RigidLinksSettings
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints

NOISE = 0.002


def of_ends(body: Known) -> FirstTree:
    return in_tree_order(neck_ends(body), 2)


def asked(body: Known, tree: FirstTree, settings: LinkedPartsSettings | None = None) -> LinkedTree:
    """The links of a tree whose joints three cuts have."""
    count = len(tree.parents)
    joints = JointConsensus(tree.rest, np.array([np.nan, *np.full(count - 1, 0.1)]), np.array([0, *np.full(count - 1, 3)]))
    return with_rigid_links(surface(body), tree, joints, NOISE, settings)


def linked(body: Known) -> FirstTree:
    return asked(body, of_ends(body)).tree


def arms(still: int | None = None) -> tuple[Known, FirstTree]:
    """A pipe of three arms, each on a link from the middle, and the tree of a cut that has arms and middle alone.

    still : an arm whose link does not turn
    """
    V, F, _ = y_pipe()
    way = np.stack([[np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3), 0.0] for k in range(3)])
    along = V @ way.T
    arm, out = along.argmax(axis=1), along.max(axis=1)
    inner, outer = (np.clip((out - at) / 8.0 + 0.5, 0.0, 1.0) for at in (6.0, 13.0))
    W, row = np.zeros((len(V), 7)), np.arange(len(V))
    W[:, 0], W[row, 1 + arm], W[row, 4 + arm] = 1.0 - inner, inner - outer, outer
    joints = np.concatenate([np.zeros((1, 3)), 6.0 * way, 13.0 * way])
    turn = swings(30, 7, 25.0, seed=4)
    turn[:, 0] = np.eye(3)
    if still is not None:
        turn[:, 1 + still] = np.eye(3)
    body = moved(V, F, W, joints, np.array([-1, 0, 0, 0, 1, 2, 3]), turn)
    seen, label = [0, 4, 5, 6], np.where(out > 10.0, 1 + arm, 0)
    tips = np.array([(V @ w).argmax() for w in way])
    cut = Cut(V, label, body.R[:, seen], body.t[:, seen], np.zeros((30, 4)))
    return body, in_tree_order(tree_joints(surface(body), cut, tips, settings=ALL_STAY), 4)


def off(body: Known, tree: FirstTree, joints: list[int]) -> np.ndarray:
    """(joint,) distance of each true joint from the nearest one of the tree, in the reference."""
    return np.linalg.norm(body.joints[joints][:, None] - tree.rest[None, 1:], axis=2).min(axis=1)


def test_a_bone_stands_between_two_parts_where_its_length_shows_it() -> None:
    body, before = neck(), of_ends(neck())
    after = linked(body)
    assert before.parents.tolist() == [-1, 0]
    assert after.parents.tolist() == [-1, 0, 1]
    assert after.place.tolist() == [0 if before.place[0] == 0 else 2, 2 if before.place[0] == 0 else 0]
    assert after.is_hidden.tolist() == [False, True, False]
    np.testing.assert_allclose(after.rest[1:], body.joints[1:], atol=0.05)
    np.testing.assert_allclose(after.drift, after.drift_at(after.rest), atol=1e-9)
    assert after.drift.max() < 0.02 * before.drift.max()


def test_the_skin_follows_the_bone_as_it_does() -> None:
    body, after = neck(), linked(neck())
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)
    assert np.abs(after.W - body.W).mean() < 0.02
    assert set(after.label) == {0, 1, 2}
    np.testing.assert_allclose(
        after.R[:, 1] @ after.R[:, 1].transpose(0, 2, 1), np.broadcast_to(np.eye(3), (24, 3, 3)), atol=1e-9
    )


@pytest.mark.parametrize(
    "settings",
    [
        LinkedPartsSettings(deviation=0.0),
        LinkedPartsSettings(skin=HiddenBonesSettings(drift=9.0)),
        LinkedPartsSettings(skin=HiddenBonesSettings(clear_drift=9.0)),
        LinkedPartsSettings(skin=HiddenBonesSettings(apart=9.0)),
        LinkedPartsSettings(skin=HiddenBonesSettings(least_vertices=10**6)),
        LinkedPartsSettings(skin=HiddenBonesSettings(area=9.0)),
        LinkedPartsSettings(skin=HiddenBonesSettings(degrees=170.0)),
    ],
    ids=["deviation", "drift", "clear_drift", "apart", "least_vertices", "area", "degrees"],
)
def test_every_sign_of_a_link_is_asked_for(settings: LinkedPartsSettings) -> None:
    body = neck()
    tree = of_ends(body)
    assert asked(body, tree, settings).tree is tree


def test_parts_that_slide_have_no_link() -> None:
    body = chain((0.0,), swings(24, 2, seed=3), blend=2.4, along=60)
    tree = of_ends(body)
    t = tree.t.copy()
    t[:, 1] += np.random.default_rng(0).normal(0.0, 0.1, t[:, 1].shape)
    slid = tree._replace(t=t)
    assert slid.drift_at(slid.rest)[1] > 0.1, "it drifts as clearly as where a link is"
    assert asked(body, slid).tree is slid


def test_bones_that_are_there_get_no_link_beside_them() -> None:
    body, once = neck(), linked(neck())
    loose = once._replace(rest=once.rest + [[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.4, 0.0, 0.0]])
    assert asked(body, loose).tree is loose


def test_several_limbs_have_their_links_in_the_order_of_the_tree() -> None:
    body, before = arms()
    after = asked(body, before).tree
    assert before.parents.tolist() == [-1, 0, 0, 0]
    assert after.parents.tolist() == [-1, 0, 1, 0, 3, 0, 5]
    assert off(body, after, [1, 2, 3, 4, 5, 6]).max() < 0.3
    for k in range(len(before.parents)):
        np.testing.assert_array_equal(after.R[:, after.place[before.place == k]], before.R[:, [k]])
    np.testing.assert_array_equal(after.radius, before.radius[[0, 1, 1, 2, 2, 3, 3]])
    np.testing.assert_array_equal(after.unexplained[:, [0, 2, 4, 6]], before.unexplained)
    assert (after.unexplained[:, [1, 3, 5]].mean(axis=0) > 0.0).all()


def test_a_part_that_was_dropped_stays_dropped() -> None:
    body, before = arms()
    after = asked(body, before._replace(place=np.append(before.place, -1))).tree
    assert len(after.parents) == 7
    assert after.place[-1] == -1


def test_a_link_that_one_take_shows_is_found_though_the_joint_drifts_little_over_all_frames() -> None:
    body, takes = and_at_rest(neck(), 150)
    tree = of_ends(body)
    clear = 0.5 * float(of_ends(neck()).drift[1] / tree.radius[1])
    settings = LinkedPartsSettings(skin=HiddenBonesSettings(clear_drift=clear))
    joints = JointConsensus(tree.rest, np.zeros(2), np.array([0, 1]))
    one, parted = (
        with_rigid_links(surface(body)._replace(takes=of), tree, joints, NOISE, settings).tree for of in (None, takes)
    )
    assert one is tree
    assert parted.parents.tolist() == [-1, 0, 1]


def test_a_limb_whose_link_does_not_turn_has_none() -> None:
    body, before = arms(still=1)
    after = asked(body, before).tree
    assert len(after.parents) == 6
    assert off(body, after, [1, 3, 4, 6]).max() < 0.3


def test_joints_of_a_link_are_of_one_cut_and_all_others_of_as_many_as_before() -> None:
    body, before = arms(still=1)
    found = asked(body, before)
    is_of_link = found.tree.is_hidden | found.tree.is_hidden[found.tree.parents] & (np.arange(6) > 0)
    assert is_of_link.sum() == 4
    assert found.joints.agreeing.tolist() == [0, *np.where(is_of_link, 1, 3)[1:]]
    np.testing.assert_array_equal(np.isnan(found.joints.spread), is_of_link | (np.arange(6) == 0))
    np.testing.assert_array_equal(found.joints.rest, found.tree.rest)


def test_joints_are_where_all_cuts_have_them_before_links_are_looked_for() -> None:
    body, tree = arms(still=1)[0], arms(still=1)[1]
    moved_to = tree.rest + [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], [0.0, 0.0, 0.5], [0.0, 0.0, 0.5]]
    found = with_rigid_links(surface(body), tree, JointConsensus(moved_to, np.zeros(4), np.full(4, 2)), NOISE)
    kept = [k for k in range(1, 6) if not found.tree.is_hidden[[k, found.tree.parents[k]]].any()]
    assert len(kept) == 1
    np.testing.assert_array_equal(found.tree.rest[kept[0]], moved_to[2])


@pytest.mark.parametrize("found", [1, 3])
def test_links_that_are_not_found_by_themselves_are_found_as_mirror_images_of_another(
    found: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    body, before = arms()
    by_itself, asked_of = linked_parts.likeliest_link, []

    def once(between: Between, joint: Floats, chosen: RigidLinksSettings) -> RigidLink:
        asked_of.append(joint)
        link = by_itself(between, joint, chosen)
        return link if len(asked_of) == found else link._replace(deviation=np.inf)

    begun, from_there = list[Floats](), linked_parts.rigid_link

    def listening(between: Between, expected: Floats, *of: Any) -> RigidLink:
        begun.append(expected)
        return from_there(between, expected, *of)

    monkeypatch.setattr(linked_parts, "likeliest_link", once)
    monkeypatch.setattr(linked_parts, "rigid_link", listening)
    after = asked(body, before).tree
    assert (len(asked_of), len(begun)) == (3, 2)
    assert after.parents.tolist() == [-1, 0, 1, 0, 3, 0, 5]
    assert off(body, after, [1, 2, 3, 4, 5, 6]).max() < 2.5, "arms are 24 long"
    others = np.argsort(np.linalg.norm(body.joints[4:] - asked_of[found - 1], axis=1))[1:]
    for k in others:
        assert min(np.linalg.norm(two - body.joints[[1 + k, 4 + k]], axis=1).max() for two in begun) < 3.0
