"""Two limbs that turn as one part about one line are cut apart by their shape."""

import numpy as np
import pytest
from limbs import rotation
from shapes import y_pipe
from shipped import TREE
from whole_tree import whole_tree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface, surface_areas
from kinetree.tasks.numerics.structure import agreed_tree, limbs_apart
from kinetree.tasks.numerics.structure.alike_limbs import AlikeLimbsSettings, alike_limbs
from kinetree.tasks.numerics.structure.joint_partners import PAIRED
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, part_tree
from kinetree.tasks.numerics.structure.pruning import NO_PART, Pruned, pruned
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints

V, F, _ = y_pipe()
"""A trunk along x from the fork at 0, and two legs at 60° on either side of −x."""
FRAMES = 16
HIP = 2.0
"""Height of the line about which the legs turn; the crotch is at −5."""
LINE = (0.0, 1.0, 0.0)
LEGS = np.array([np.argmax(V[:, 1]), np.argmin(V[:, 1])])
HEAD, SIDE = int(np.argmax(V[:, 0])), int(np.argmin(np.linalg.norm(V - [16.0, 0.0, 4.0], axis=1)))
LEAVES = np.array([*LEGS, HEAD, SIDE])
KNEES = np.where(V[:, 0] < -9.0, np.where(V[:, 1] > 0.0, 2, 3), 0)
"""(vertex,) shanks as parts 2 and 3."""


def seen(
    axis: tuple[float, float, float] = LINE, hip: float = HIP, border: float = HIP, beyond: Ints | None = None
) -> tuple[MovingSurface, MovingParts]:
    """The pipe, whose legs swing as part 1 about a line through (hip, 0, 0) against the trunk; shanks and others go along."""
    label = (V[:, 0] < border).astype(np.int64)
    if beyond is not None:
        label = np.where(beyond > 0, beyond, label)
    count, at = int(label.max()) + 1, np.array([hip, 0.0, 0.0])
    R, t = np.tile(np.eye(3), (FRAMES, count, 1, 1)), np.zeros((FRAMES, count, 3))
    for f, angle in enumerate(np.radians(20.0) * np.sin(np.arange(FRAMES))):
        R[f, 1:] = rotation(axis, angle)
        for part in range(2, count):
            R[f, part] = R[f, 1] @ rotation((0.0, 0.0, 1.0), np.radians(15.0) * np.cos(f + part))
        t[f, 1:] = at - R[f, 1] @ at
        for part in range(2, count):
            own = V[label == part]
            knee = own[own[:, 0] > own[:, 0].max() - 1.0].mean(axis=0)
            t[f, part] = R[f, 1] @ knee + t[f, 1] - R[f, part] @ knee
    x = np.array([np.einsum("vxy,vy->vx", R[f, label], V) + t[f, label] for f in range(FRAMES)])
    still = np.full((FRAMES, count), 0.01)
    return MovingSurface(V, F, x, surface_areas(V, F)), MovingParts(label, R, t, still, np.ones((FRAMES, count)))


def of_legs(tips: Ints = LEGS) -> LimbPairs:
    return LimbPairs(tips[None], geodesic_distance(Surface.of(V, F), tips)[None])


def found(
    body: MovingSurface,
    parts: MovingParts,
    pairs: LimbPairs | None = None,
    settings: AlikeLimbsSettings | None = None,
    leaves: Ints = LEGS,
) -> tuple[int, Ints] | None:
    both = of_legs() if pairs is None else pairs
    return next(alike_limbs(body, parts, part_tree(body, parts), leaves, both, settings), None)


def test_legs_that_swing_as_one_are_two() -> None:
    one = found(*seen())
    assert one is not None
    part, other = one
    assert part == 1
    own, second = V[:, 0] < HIP, np.isin(np.arange(len(V)), other)
    np.testing.assert_array_equal(second[own & (np.abs(V[:, 1]) > 1e-6)], V[own & (np.abs(V[:, 1]) > 1e-6), 1] < 0.0)
    assert not second[~own].any()


def test_knees_are_no_neighbours_but_on_the_way() -> None:
    one = found(*seen(beyond=KNEES))
    assert one is not None
    assert one[0] == 1


def test_a_part_with_two_more_neighbours_is_no_pair_of_limbs() -> None:
    tail = np.where((V[:, 2] > 3.0) & (V[:, 0] < -2.0) & (np.abs(V[:, 1]) < 4.0), 4, KNEES)
    assert (tail == 4).sum() > 4
    assert found(*seen(beyond=tail)) is None


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)], ids=["twisted", "bent aside"])
def test_limbs_that_turn_about_another_line_are_a_trunk_that_bends(axis: tuple[float, float, float]) -> None:
    assert found(*seen(axis)) is None


@pytest.mark.parametrize(("degrees", "is_one"), [(30.0, True), (40.0, False)])
def test_how_far_the_line_may_lean(degrees: float, is_one: bool) -> None:
    """Cosine 0.87 and 0.77."""
    lean = np.radians(degrees)
    assert (found(*seen((np.sin(lean), np.cos(lean), 0.0))) is not None) == is_one


def test_a_joint_high_above_the_crotch_is_of_a_spine() -> None:
    assert found(*seen(hip=8.0)) is None
    assert found(*seen(hip=8.0), settings=AlikeLimbsSettings(near=9.0)) is not None


@pytest.mark.parametrize(("hip", "is_one"), [(5.0, True), (5.5, False)])
def test_how_high_above_the_crotch_a_joint_may_lie(hip: float, is_one: bool) -> None:
    """1.69 and 1.81 radii from the line."""
    assert (found(*seen(hip=hip)) is not None) == is_one


@pytest.mark.parametrize(("limb", "is_one"), [(0.35, True), (0.37, False)])
def test_how_much_of_the_part_each_limb_must_have(limb: float, is_one: bool) -> None:
    """With the trunk up to 20 each has 0.36 of it."""
    assert (found(*seen(border=20.0), settings=AlikeLimbsSettings(near=9.0, limb=limb)) is not None) == is_one


def test_a_part_with_a_third_end_is_no_pair_of_limbs() -> None:
    """As a chest with both arms and the head."""
    third = int(np.argmin(np.linalg.norm(V - [-2.0, 0.0, 4.0], axis=1)))
    assert found(*seen(), leaves=np.array([*LEGS, HEAD])) is not None
    assert found(*seen(), leaves=np.array([*LEGS, HEAD, third])) is None


@pytest.mark.parametrize(
    ("limb", "near", "is_one"), [(0.47, 9.0, True), (0.49, 9.0, False), (0.3, 0.9, False), (0.3, 1.3, True)]
)
def test_limits_of_share_and_distance(limb: float, near: float, is_one: bool) -> None:
    """Each leg has 0.48 of the part; the joint lies 1.1 radii from the line between them."""
    assert (found(*seen(), settings=AlikeLimbsSettings(limb=limb, near=near)) is not None) == is_one


def test_a_part_without_area_is_none() -> None:
    body, parts = seen()
    assert found(body._replace(area=np.where(parts.label == 1, 0.0, body.area)), parts) is None


def test_ends_that_no_path_joins_are_none() -> None:
    pairs = of_legs()
    distance = pairs.distance.copy()
    distance[0, 0, LEGS[1]] = distance[0, 1, LEGS[0]] = np.inf
    assert found(*seen(), LimbPairs(pairs.tip, distance)) is None


def test_a_body_of_one_part_has_none() -> None:
    body, _ = seen()
    whole = MovingParts(np.zeros(len(V), np.int64), np.tile(np.eye(3), (FRAMES, 1, 1, 1)), *np.zeros((2, FRAMES, 1, 3))[:1],
                        np.zeros((FRAMES, 1)), np.ones((FRAMES, 1)))  # fmt: skip
    assert found(body, whole) is None


def test_legs_apart_hang_on_the_trunk_and_the_cut_has_one_of_them() -> None:
    left = pruned_parts()
    tree = left.part_tree.tree
    place = np.argsort(tree.order)
    on = {int(tree.order[tree.parents[place[part]]]) if tree.parents[place[part]] >= 0 else None for part in (1, 2)}
    assert on in ({0}, {0, None}), "of one of them the trunk may hang"
    assert left.origin.tolist() == [0, 1, NO_PART]
    np.testing.assert_array_equal(left.parts.R[:, 2], left.parts.R[:, 1])
    rows = [np.flatnonzero((left.part_tree.borders.pair == [0, part]).all(axis=1))[0] for part in (1, 2)]
    low, high = np.sort(left.part_tree.joints.rest[rows, 1])
    assert low < -0.7
    assert high > 0.7


def test_where_every_vertex_was_followed_limbs_stay_one_part() -> None:
    body, parts = seen()
    cut = Cut(V, parts.label, parts.R, parts.t, parts.residual)
    assert tree_joints(body, cut, LEAVES, settings=TREE).R.shape[1] == 2
    assert tree_joints(body, cut, LEAVES, np.ones((FRAMES, len(V))), settings=TREE).R.shape[1] == 3


def test_each_leg_is_as_certain_as_its_own_surface() -> None:
    hidden = np.ones((FRAMES, len(V)))
    hidden[::2, (V[:, 0] < HIP) & (V[:, 1] < 0.0)] = 0.0
    seen_share = pruned_parts(hidden).parts.confidence
    assert seen_share is not None
    assert seen_share[:, 1].min() > 0.9
    assert seen_share[::2, 2].max() < 0.1
    assert seen_share[1::2, 2].min() > 0.9


def test_hips_of_legs_that_swing_as_one_stay_two() -> None:
    """Any place on the line of both explains both."""
    body, parts = seen()
    cut = Cut(V, parts.label, parts.R, parts.t, parts.residual)
    tree, _ = whole_tree(body, cut, LEAVES, np.ones((FRAMES, len(V))), settings=TREE)
    hips = [j for j, kind in enumerate(tree.kinds) if kind == "joint"]
    assert len(hips) == 2
    assert np.linalg.norm(tree.rest[hips[0]] - tree.rest[hips[1]]) > 1.4


def test_a_candidate_that_cannot_be_cut_hides_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """A spine whose both sides a candidate wrongly names would hang on the other."""
    upper = np.flatnonzero(V[:, 0] > 12.0)
    monkeypatch.setattr(limbs_apart, "alike_limbs", lambda *of: [(0, upper), *alike_limbs(*of)])
    left = pruned_parts()
    assert len(left.origin) == 3
    assert set(left.parts.label[upper]) == {0}


def pruned_parts(trust: Floats | None = None, is_given: bool = False) -> Pruned:
    """The pipe in two parts, pruned; trust (frame, vertex) 0 to 1."""
    body, parts = seen()
    assert {*LEGS.tolist()} in [set(tip) for tip in limb_pairs(V, F, LEAVES).tip.tolist()]
    confidence = np.ones((FRAMES, len(V))) if trust is None else trust
    if is_given:
        return pruned(body, parts._replace(confidence=None), LEAVES, settings=TREE.pruning)
    left = pruned(body, parts, LEAVES, settings=TREE.pruning)
    return limbs_apart.with_limbs_apart(body, left, LEAVES, limb_pairs(V, F, LEAVES), confidence, PAIRED)


def test_two_limbs_of_one_part_count_as_no_part_of_a_limb() -> None:
    pairs = limb_pairs(V, F, LEAVES)
    apart, whole = pruned_parts(), pruned_parts(is_given=True)
    assert (agreed_tree._in_limbs(apart, pairs), agreed_tree._in_limbs(whole, pairs)) == (2, 0)
