"""Flesh of the trunk that one of two thighs holds goes back to the trunk."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from legs import ALONG, FRAMES, HIP, LEAVES, LEGS, F, Legs, V, of_legs
from shipped import TREE

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure import agreed_tree
from kinetree.tasks.numerics.structure import unlike_borders as numerics
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.joint_partners import MirroredLimbs, RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.limbs_apart import moving_by_themselves
from kinetree.tasks.numerics.structure.part_tree import MovingSurface, PartPairs, PartTree, part_tree
from kinetree.tasks.numerics.structure.pruning import Pruned
from kinetree.tasks.numerics.structure.rotation_centres import Borders, borders
from kinetree.tasks.numerics.structure.tree_joints import tree_of_parts
from kinetree.tasks.numerics.structure.unlike_borders import Flesh, UnlikeBordersSettings, unlike_borders

ONES = np.ones((FRAMES, len(V)))
OUTSIDE = {side: V @ np.array([0.0, np.sign(leg[1]), 0.0]) for side, leg in LEGS.items()}


def flesh_of(side: str) -> Flags:
    """(vertex,) the side of pelvis and chest that one leg's thigh holds."""
    return np.asarray((ALONG[side] <= HIP) & (OUTSIDE[side] > 0.0) & (V[:, 0] < 10.0))


def seen(*sides: str, parts: dict[str, int] | None = None) -> tuple[MovingSurface, FirstTree]:
    """The legs as a cut has them, with flesh of the trunk in the thighs of these sides."""
    legs = Legs.of(parts)
    label = legs.parts.label.copy()
    for side in sides:
        label[flesh_of(side)] = legs.parts.label[np.argmin(np.abs(ALONG[side] - 10.0))]
    count = int(label.max()) + 1
    moved = moving_by_themselves(legs.body, legs.parts._replace(label=label), range(count), ONES)
    found = part_tree(legs.body, moved)
    left = Pruned(moved, found, found, np.arange(count), ())
    return legs.body, in_tree_order(tree_of_parts(legs.body, left, np.arange(count), label, ONES, TREE), count)


def pairs() -> LimbPairs:
    """Both legs; twice, since a single pair of limbs says nothing of a body."""
    return LimbPairs(*(np.concatenate([a, a]) for a in of_legs()))


def rooted(tree: FirstTree) -> RootedParts:
    return RootedParts(tree.label, tree.parents, tree.radius)


def found_in(tree: FirstTree, settings: UnlikeBordersSettings | None = None, of: LimbPairs | None = None) -> list[Flesh]:
    return unlike_borders(V, F, rooted(tree), pairs() if of is None else of, settings=settings)


def thigh(tree: FirstTree, side: str) -> int:
    """The part of what lies amid a thigh."""
    return int(tree.label[np.argmin(np.abs(ALONG[side] - 10.0))])


def hips(tree: FirstTree) -> list[float]:
    """How far the joint of each thigh is from its true place."""
    return [float(np.linalg.norm(tree.rest[thigh(tree, side)] - HIP * leg)) for side, leg in LEGS.items()]


def ends(tree: FirstTree) -> set[frozenset[int]]:
    """What each joint joins, by vertices amid thighs and at the ends of legs and chest; −1 for the pelvis."""
    places = {int(tree.label[v]): v for v in (*(int(np.argmin(np.abs(along - 10.0))) for along in ALONG.values()), *LEAVES[:3])}
    number = [places.get(part, -1) for part in range(len(tree.parents))]
    return {frozenset((number[k], number[int(tree.parents[k])])) for k in range(1, len(tree.parents))}


@pytest.mark.parametrize("side", ["left", "right"])
def test_flesh_on_one_side_is_found(side: str) -> None:
    _, tree = seen(side)
    (one,) = found_in(tree)
    assert set(tree.label[one.vertex]) == {one.part}
    assert flesh_of(side)[one.vertex].all()
    assert len(one.vertex) > 0.4 * flesh_of(side).sum()  # the rest widens the border by less than is asked for


@pytest.mark.parametrize("sides", [(), ("left", "right")])
def test_limbs_that_are_alike_have_none(sides: Sequence[str]) -> None:
    assert found_in(seen(*sides)[1]) == []


def test_a_single_pair_of_limbs_tells_nothing() -> None:
    _, tree = seen("left")
    assert found_in(tree, of=of_legs()) == []
    assert len(found_in(tree, UnlikeBordersSettings(least_pairs=1), of_legs())) == 1


def test_how_much_wider_the_border_is() -> None:
    _, tree = seen("left")
    ratio = tree.radius[thigh(tree, "left")] / tree.radius[thigh(tree, "right")]
    assert found_in(tree, UnlikeBordersSettings(wider=1.01 * ratio)) == []
    assert len(found_in(tree, UnlikeBordersSettings(wider=0.99 * ratio))) == 1


def test_it_ends_where_the_border_is_as_wide_as_the_other_one() -> None:
    _, tree = seen("left")
    lost = [len(found_in(tree, UnlikeBordersSettings(alike=alike))[0].vertex) for alike in (1.4, 1.15, 1.05)]
    assert lost[0] < lost[1] <= lost[2]
    assert found_in(tree, UnlikeBordersSettings(alike=0.1)) == []


def test_too_few_vertices_are_none() -> None:
    _, tree = seen("left")
    count = len(found_in(tree)[0].vertex)
    assert len(found_in(tree, UnlikeBordersSettings(least_vertices=count))) == 1
    assert found_in(tree, UnlikeBordersSettings(least_vertices=count + 1)) == []


def test_something_is_left_of_the_part() -> None:
    """The ring is as narrow as one likes at the end of a limb, beyond which nothing is left."""
    whole = {"pelvis": 0, "left thigh": 1, "left shank": 1, "right thigh": 2, "right shank": 2, "chest": 3}
    _, tree = seen("left", parts=whole)
    assert len(found_in(tree)) == 1
    assert len(found_in(tree, UnlikeBordersSettings(alike=0.3, least_vertices=1))) == 1
    assert found_in(tree, UnlikeBordersSettings(alike=0.3, least_vertices=60)) == []


def test_limbs_whose_thighs_touch_have_none() -> None:
    """Either may hold the pelvis."""
    _, tree = seen("left")
    near = (tree.label == tree.parents[thigh(tree, "left")]) & (V[:, 0] < 3.0)
    assert found_in(tree._replace(label=np.where(near, thigh(tree, "right"), tree.label))) == []


@pytest.mark.parametrize(("radius", "lowest"), [(2.0, 0.0), (6.0, 0.0), (99.0, np.inf)])
def test_flesh_ends_a_radius_before_the_next_joint(radius: float, lowest: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """An oblique ring there is on the part in no more than a piece, which is as narrow as one likes."""
    _, tree = seen("left")
    (limbs, _) = numerics.mirrored_limbs(F, rooted(tree), pairs())
    away, tried = of_legs().distance[0, 0], [np.inf]
    is_own = tree.label == thigh(tree, "left")

    def tried_with(_V: Floats, _F: Ints, is_limb: Ints) -> Borders:
        tried.append(float(away[is_own & (is_limb > 0)].max()))
        return borders(_V, _F, is_limb)

    monkeypatch.setattr(numerics, "borders", tried_with)
    nothing = UnlikeBordersSettings(alike=0.0)
    assert len(numerics._flesh(V, F, rooted(tree), limbs.one, away, radius, nothing)) == 0
    least = float(limbs.one.level[-2]) + radius
    assert min(tried) >= max(least - 1.0, lowest)
    assert (min(tried) < least + 1.0) == (lowest == 0.0)


def test_flesh_hangs_together_with_the_trunk() -> None:
    """What lies apart from it on the limb's part is none of its flesh."""
    _, tree = seen("left")
    left = thigh(tree, "left")
    assert tree.label[np.argmax(V[:, 0])] != tree.parents[left]
    far = (V[:, 0] > 20.0) & (V[:, 1] > 0.0)
    sleeve = rooted(tree._replace(label=np.where(far, left, tree.label)))
    assert unlike_borders(V, F, sleeve, pairs(), np.inf) == []


def test_part_that_no_path_reaches_has_none() -> None:
    _, tree = seen("left")
    (limbs, _) = numerics.mirrored_limbs(F, rooted(tree), pairs())
    away = np.full(len(V), np.inf)
    for limb in (limbs.one, limbs.one._replace(part=limbs.one.part[-1:], level=limbs.one.level[-1:])):
        assert len(numerics._flesh(V, F, rooted(tree), limb, away, 4.0, UnlikeBordersSettings())) == 0


def test_partners_are_those_of_the_tree(monkeypatch: pytest.MonkeyPatch) -> None:
    _, tree = seen("left")
    given: list[float] = []
    real = numerics.mirrored_limbs
    monkeypatch.setattr(numerics, "mirrored_limbs", lambda *of: given.append(of[-1]) or real(*of))
    unlike_borders(V, F, rooted(tree), pairs(), 1.75)
    assert given == [1.75]


@pytest.mark.parametrize(
    "changed",
    [
        lambda limbs: limbs._replace(row=limbs.row[:1]),
        lambda limbs: limbs._replace(row=np.array([[0, 1], [1, 0]])),
        lambda limbs: limbs._replace(one=limbs.one._replace(part=limbs.one.part[[0, 0, 1]], level=limbs.one.level[[0, 0, 1]])),
        lambda limbs: limbs._replace(other=limbs.other._replace(part=limbs.other.part[[0, 1, 1]])),
        lambda limbs: limbs._replace(
            one=limbs.one._replace(part=limbs.one.part[:0]),
            other=limbs.other._replace(part=limbs.other.part[:0]),
            row=limbs.row[:0],
        ),
    ],
)
def test_all_joints_are_partners(changed: Callable[[MirroredLimbs], MirroredLimbs], monkeypatch: pytest.MonkeyPatch) -> None:
    _, tree = seen("left")
    real = numerics.mirrored_limbs
    monkeypatch.setattr(numerics, "mirrored_limbs", lambda *of: [changed(limbs) for limbs in real(*of)])
    assert found_in(tree) == []


def test_limb_that_carries_another_one_has_none() -> None:
    _, tree = seen("left")
    (one,) = found_in(tree)
    chest = int(tree.label[np.argmax(V[:, 0])])
    assert found_in(tree._replace(parents=np.where(np.arange(len(tree.parents)) == chest, one.part, tree.parents))) == []


def test_its_joint_goes_where_the_limb_turns() -> None:
    body, tree = seen("left")
    left = agreed_tree._without_flesh(body, tree, pairs(), ONES, TREE)
    (before, other), (after, same) = hips(tree), hips(left)
    assert after < 0.5 * before
    assert same == pytest.approx(other, abs=0.2)
    assert ends(left) == ends(tree)
    trust = np.random.default_rng(0).uniform(size=ONES.shape)
    unsure = agreed_tree._without_flesh(body, tree, pairs(), trust, TREE)
    share = confident_share(unsure.label, body.area, trust, FRAMES, len(unsure.parents))
    assert unsure.certain_share == pytest.approx(share)


def test_the_trunk_is_fitted_anew() -> None:
    body, tree = seen("left")
    cut = agreed_tree._without_flesh(body, tree, pairs(), ONES, TREE)
    chest = [int(one.parents[thigh(one, "left")]) for one in (tree, cut)]
    assert np.abs(tree.t[:, chest[0]] - cut.t[:, chest[1]]).max() > 0.0


def test_tree_stays_if_a_joint_would_go(monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = seen("left")
    real, asked = agreed_tree.joints_of, list[PartTree]()

    def of_fewer(found: PartTree) -> PartPairs:
        asked.append(found)
        return frozenset(sorted(real(found), key=sorted)[: 2 if len(asked) == 2 else None])

    monkeypatch.setattr(agreed_tree, "joints_of", of_fewer)
    assert agreed_tree._without_flesh(body, tree, pairs(), ONES, TREE) is tree


def test_nothing_changes_where_there_is_none() -> None:
    body, tree = seen()
    assert agreed_tree._without_flesh(body, tree, pairs(), ONES, TREE) is tree


@pytest.mark.parametrize("is_aligned", [True, False])
def test_agreed_tree_is_without_it_where_vertices_were_aligned(is_aligned: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = seen("left")
    monkeypatch.setattr(agreed_tree, "limb_pairs", lambda *_: pairs())
    trust = ONES if is_aligned else None
    left = agreed_tree.agreed_tree(body, [tree], LEAVES, trust, settings=TREE).tree
    assert (hips(left)[0] < 0.5 * hips(tree)[0]) == is_aligned
