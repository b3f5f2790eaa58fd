"""Which parts have a joint that the mirror image of their limb lacks, and are flesh."""

import numpy as np
import pytest
from articulated import Known, chain, surface, swings
from limbs import rotation
from shipped import PRUNING

from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, part_tree
from kinetree.tasks.numerics.structure.pruning import UNPAIRED, pruned
from kinetree.tasks.numerics.structure.unpaired_parts import UnpairedPartsSettings, unpaired_joints, unpaired_parts

FRAMES = 24


def ends(body: Known) -> np.ndarray:
    """Of both limbs, and two on the sides of the trunk, without which no pair is known."""
    sides = [int(np.argmin(np.linalg.norm(body.V - [x, 0.0, 0.0], axis=1))) for x in (1.0, -1.0)]
    return np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax(), *sides])


def pairs_of(body: Known) -> LimbPairs:
    return limb_pairs(body.V, body.F, ends(body))


def found_in(body: Known, settings: UnpairedPartsSettings | None = None, is_aligned: bool = False) -> int:
    parts = MovingParts(body.label, body.R, body.t, body.residual, np.ones(body.R.shape[:2]) if is_aligned else None)
    return next(unpaired_parts(body.F, parts, part_tree(surface(body), parts), pairs_of(body), settings), -1)


def bent_at(*heights: float) -> Known:
    return chain(heights, swings(FRAMES, len(heights) + 1, 25, seed=2), along=60)


@pytest.mark.parametrize(
    ("heights", "part"),
    [
        ((-1.0, 1.0), -1),
        ((-3.5, -1.0, 1.0, 2.2, 3.5), 3),
        ((-3.5, -2.2, -1.0, 1.0, 3.5), 2),
        ((-3.5, -2.2, -1.0, 1.0, 2.2, 3.5), -1),
        ((-3.5, -1.0, 1.0, 2.35, 3.5), 4),
        ((-4.3, -0.2, 0.2, 1.9, 4.3), 3),
        ((-4.3, -0.2, 0.2, 2.2, 4.3), -1),
        ((-1.5, 1.5, 2.7), 2),
        ((-1.5, 1.5, 2.9), -1),
    ],
    ids=[
        "a pair", "a ring on one side", "on the other", "on both sides", "the shorter one first", "1.7 radii", "2 radii",
        "an end of 1.2 radii", "of 1.4",
    ],
)  # fmt: skip
def test_short_part_of_one_limb_alone_is_flesh(heights: tuple[float, ...], part: int) -> None:
    assert found_in(bent_at(*heights)) == part


@pytest.mark.parametrize(("near", "part"), [(1.1, -1), (1.3, 3)])
def test_how_near_its_joints_may_lie(near: float, part: int) -> None:
    """They lie 1.2 radii apart, and the next one 1.3."""
    body = bent_at(-3.5, -1.0, 1.0, 2.2, 3.5)
    assert found_in(body, UnpairedPartsSettings(near=near)) == part


@pytest.mark.parametrize(("axis", "part"), [((0.0, 0.0, 1.0), -1), ((1.0, 0.0, 0.0), 2)], ids=["twists", "bends"])
def test_part_of_the_trunk_stays_if_the_other_limb_might_hang_on_it(axis: tuple[float, float, float], part: int) -> None:
    """About its own axis the part carries the far limb's joint as the trunk does, for it lies on the axis."""
    turn = swings(FRAMES, 4, 25, seed=2)
    turn[:, 2] = [rotation(axis, 0.5 * np.sin(2 * np.pi * f / FRAMES)) for f in range(FRAMES)]
    assert found_in(chain((-2.0, 1.0, 2.0), turn, along=60)) == part


@pytest.mark.parametrize(("slide", "part"), [(0.7, -1), (1.3, 2)], ids=["1.2 times", "1.6 times"])
def test_its_joint_may_drift_a_third_more_there_than_where_it_hangs(slide: float, part: int) -> None:
    """The far limb slides on the trunk, and the part slides so many times as far."""
    turn = swings(FRAMES, 4, 25, seed=2)
    turn[:, 2] = [rotation((0.0, 0.0, 1.0), 0.5 * np.sin(2 * np.pi * f / FRAMES)) for f in range(FRAMES)]
    body, t = chain((-2.0, 1.0, 2.0), turn, along=60), np.random.default_rng(0).normal(size=(2, FRAMES, 3))
    off = body.t.copy()
    off[:, 0] += 0.1 * t[0]
    off[:, [2, 3]] += 0.1 * slide * t[1][:, None]
    assert found_in(body._replace(t=off)) == part


@pytest.mark.parametrize(("slide", "part"), [(0.02, -1), (0.05, 2)], ids=["0.05 radii", "0.13 radii"])
def test_drift_within_the_noise_of_an_alignment_is_none(slide: float, part: int) -> None:
    """The far limb slides by nothing on the trunk, and a little on the part."""
    turn = swings(FRAMES, 4, 25, seed=2)
    turn[:, 2] = [rotation((0.0, 0.0, 1.0), 0.5 * np.sin(2 * np.pi * f / FRAMES)) for f in range(FRAMES)]
    body = chain((-2.0, 1.0, 2.0), turn, along=60)
    off = body.t.copy()
    off[:, [2, 3]] += slide * np.random.default_rng(0).normal(size=(FRAMES, 1, 3))
    assert found_in(body._replace(t=off), is_aligned=True) == part
    assert found_in(body._replace(t=off)) == 2


def test_part_within_a_limb_carries_nothing_but_the_limb() -> None:
    """It twists about the axis on which the far limb's joint lies, and is flesh all the same."""
    turn = swings(FRAMES, 8, 25, seed=2)
    for part in (4, 5):
        turn[:, part] = [rotation((0.0, 0.0, 1.0), 0.5 * np.sin(2 * np.pi * f * part / FRAMES)) for f in range(FRAMES)]
    assert found_in(chain((-4.2, -1.9, -0.5, 0.5, 1.9, 3.0, 4.2), turn, along=60)) == 5


def test_body_of_one_part_has_no_joints_and_none_goes() -> None:
    body = chain((), swings(8, 1))
    parts = MovingParts(body.label, body.R, body.t, body.residual)
    left = pruned(surface(body), parts, ends(body), settings=PRUNING)
    assert left.parts.R.shape[1] == 1
    assert unpaired_joints(body.F, RootedParts.of(body.label, left.part_tree), pairs_of(body)) == 0
    assert found_in(body) == -1


def test_part_of_which_a_third_limb_hangs_stays() -> None:
    """A piece of the side above the joint hangs on the ring."""
    body = bent_at(-4.0, -0.5, 0.5, 1.7, 4.0)
    assert found_in(body) == 3
    side = (np.abs(body.V[:, 2] - 1.1) < 0.4) & (body.V[:, 0] > 0.6)
    label = np.where(side, 6, body.label)
    lean = np.stack([rotation((0.0, 1.0, 0.0), 0.6 * np.sin(2 * np.pi * f / FRAMES)) for f in range(FRAMES)])
    own = body.R[:, 3] @ lean
    joint = np.array([1.0, 0.0, 1.1])
    t = np.einsum("txy,y->tx", body.R[:, 3], joint) + body.t[:, 3] - np.einsum("txy,y->tx", own, joint)
    R, t = np.concatenate([body.R, own[:, None]], axis=1), np.concatenate([body.t, t[:, None]], axis=1)
    x = body.x.copy()
    x[:, side] = np.einsum("txy,vy->tvx", own, body.V[side]) + t[:, 6][:, None]
    assert found_in(body._replace(label=label, R=R, t=t, x=x)) == -1


def test_pruning_drops_it_and_says_why() -> None:
    body = bent_at(-3.5, -1.0, 1.0, 2.2, 3.5)
    left = pruned(surface(body), MovingParts(body.label, body.R, body.t, body.residual), ends(body), settings=PRUNING)
    assert [(d.part, d.reason) for d in left.dropped] == [(3, UNPAIRED)]
    assert left.origin.tolist() == [0, 1, 2, 4, 5]
    lonely = pruned(surface(body), MovingParts(body.label, body.R, body.t, body.residual), ends(body)[:1], settings=PRUNING)
    assert lonely.dropped == ()


@pytest.mark.parametrize(
    ("heights", "count"),
    [((-1.0, 1.0), 0), ((-2.5, 1.0), 0), ((-4.0, 1.0), 2), ((-3.5, -1.0, 1.0, 2.2, 3.5), 1), ((-3.0, -1.0, 2.9), 1)],
)
def test_joints_without_a_partner_are_counted(heights: tuple[float, ...], count: int) -> None:
    body = bent_at(*heights)
    parts = MovingParts(body.label, body.R, body.t, body.residual)
    assert unpaired_joints(body.F, RootedParts.of(body.label, part_tree(surface(body), parts)), pairs_of(body)) == count


def test_pruning_keeps_it_where_as_many_joints_would_be_without_a_partner(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without it a thigh may hang on the other thigh, and its hip has no partner then."""
    body = bent_at(-3.5, -1.0, 1.0, 2.2, 3.5)
    monkeypatch.setattr("kinetree.tasks.numerics.structure.pruning.unpaired_joints", lambda *of: 1)
    assert (
        pruned(surface(body), MovingParts(body.label, body.R, body.t, body.residual), ends(body), settings=PRUNING).dropped
        == ()
    )
