"""Which parts are parts."""

import numpy as np
import pytest
from articulated import Known, chain, moved, swings, three_arms
from shipped import PRUNING

from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.joint_rotations import in_between
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, part_tree
from kinetree.tasks.numerics.structure.pruning import FLESH, SLIDING, STILL, Dropped, Pruned, pruned, without_flat_ends


def of(body: Known, leaves: tuple[int, ...] = (), takes: list[slice] | None = None) -> Pruned:
    parts = MovingParts(body.label, body.R, body.t, body.residual)
    return pruned(
        MovingSurface(body.V, body.F, body.x, body.area, takes), parts, np.array(leaves, dtype=np.int64), settings=PRUNING
    )


@pytest.mark.parametrize("body", [chain((-2.0, 2.0)), chain((0.0,)), three_arms()], ids=["three links", "two links", "arms"])
def test_true_parts_stay(body: Known) -> None:
    found = of(body)
    assert found.parts.label.tolist() == body.label.tolist()
    assert found.dropped == ()
    assert found.origin.tolist() == list(range(len(found.origin)))


def test_ring_of_flesh_around_a_joint_is_no_part() -> None:
    hinge = swings(24, 1, 40, axes=1)[:, 0]
    half = swings(24, 1, 20, axes=1)[:, 0]
    turn = np.stack([np.broadcast_to(np.eye(3), (24, 3, 3)), half, half], axis=1)
    assert half @ half == pytest.approx(hinge, abs=1e-9)
    body = chain((-0.4, 0.4), turn)
    found = of(body)
    assert found.parts.R.shape[1] == 2
    assert found.dropped == (Dropped(1, FLESH),)
    assert found.origin.tolist() == [0, 2]
    assert len(found.before.borders.pair) == 2
    assert found.part_tree.joints.rest[found.part_tree.tree.border[1]][2] == pytest.approx(0, abs=0.2)


@pytest.mark.parametrize(
    ("half_length", "in_limb", "dropped"),
    [
        (0.55, (True, True, True), True),
        (0.7, (True, True, True), False),
        (0.55, (True, False, True), False),
        (0.4, (True, False, True), True),
        (0.55, (False, False, False), True),
    ],
    ids=["1.1 radii in a limb", "1.4", "1.1 in the trunk", "0.8", "1.1 of a body without limbs that have mirror images"],
)
def test_ring_of_flesh_is_shorter_in_a_trunk(
    half_length: float, in_limb: tuple[bool, ...], dropped: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    half = swings(24, 1, 20, axes=1)[:, 0]
    body = chain((-half_length, half_length), np.stack([np.broadcast_to(np.eye(3), (24, 3, 3)), half, half], axis=1))

    def by_part(parts: RootedParts, pairs: LimbPairs) -> np.ndarray:
        ring = parts.place[np.abs(body.V[:, 2]).argmin()]
        return np.array([in_limb[1 if part == ring else 0] for part in range(len(parts.parents))])

    monkeypatch.setattr("kinetree.tasks.numerics.structure.pruning.in_mirrored_limbs", by_part)
    assert of(body).dropped == ((Dropped(1, FLESH),) if dropped else ())


@pytest.mark.parametrize(("half_length", "dropped"), [(0.3, (Dropped(1, FLESH),)), (0.55, ())])
def test_of_several_takes_a_part_must_follow_the_less_the_shorter_it_is_to_be_flesh(
    half_length: float, dropped: tuple[Dropped, ...]
) -> None:
    """The middle turns by half of the joint's turn and by itself, and slides a little."""
    hinge, own = swings(24, 1, 20, axes=1)[:, 0], swings(24, 2, 14, axes=1, seed=3)[:, 1]
    turn = np.stack([np.broadcast_to(np.eye(3), (24, 3, 3)), hinge @ own, hinge @ own.transpose(0, 2, 1)], axis=1)
    assert in_between(turn[:, 1], turn[:, 1] @ turn[:, 2]) == pytest.approx(0.67, abs=0.02)
    body = chain((-half_length, half_length), turn)
    slide = 0.03 * np.random.default_rng(2).normal(size=(24, 3))
    t, x = body.t.copy(), body.x.copy()
    t[:, 1] += slide
    x[:, body.label == 1] += slide[:, None]
    body = body._replace(t=t, x=x)
    assert of(body, takes=[slice(0, 12), slice(12, 24)]).dropped == dropped
    assert of(body).dropped == of(body, takes=[slice(0, 24)]).dropped == ()


def test_parts_that_do_not_turn_are_one() -> None:
    turn = swings(24, 3)
    turn[:, 2] = np.eye(3)
    found = of(chain((-1.0, 2.0), turn))
    assert found.parts.R.shape[1] == 2
    assert [dropped.reason for dropped in found.dropped] == [STILL]
    assert of(chain((-1.0, 2.0), np.tile(np.eye(3), (24, 3, 1, 1)))).parts.R.shape[1] == 1


def test_patch_that_slides_is_no_part() -> None:
    body = chain((-2.0, 2.0))
    patch = (np.abs(body.V[:, 2]) < 0.8) & (body.V[:, 0] > 0.5)
    W = np.eye(4)[np.where(patch, 3, body.label)]
    known = moved(body.V, body.F, W, np.vstack([body.joints, [1.0, 0, 0]]), np.array([-1, 0, 1, 1]), swings(24, 4, 10))
    slide = 0.5 * np.random.default_rng(2).normal(size=(24, 3))
    t, x = known.t.copy(), known.x.copy()
    t[:, 3] += slide
    x[:, patch] += slide[:, None]
    found = of(known._replace(t=t, x=x), (int(np.flatnonzero(patch)[0]),))
    assert found.parts.R.shape[1] == 3
    assert found.dropped == (Dropped(3, SLIDING),)


@pytest.mark.parametrize(
    ("shape", "has_leaf", "dropped"),
    [("strip", False, (FLESH,)), ("strip", True, ()), ("square", False, (FLESH,)), ("end", False, ())],
)
def test_last_part_that_hardly_reaches_beyond_its_border_is_flesh_unless_it_has_a_leaf(
    shape: str, has_leaf: bool, dropped: tuple[str, ...]
) -> None:
    """A strip along the tube, 1.1 wide, a square and the last 1.6 of the tube turn alike."""
    tube = chain((-4.0,))
    (x, _, z) = tube.V.T
    own = {"strip": (np.abs(z) < 2.5) & (x > 0.8), "square": (np.abs(z) < 0.7) & (x > 0.8), "end": z > 3.4}[shape]
    W = np.eye(3)[np.where(own, 2, tube.label)]
    joints = np.vstack([tube.joints, [0.9, 0.0, 0.0] if shape != "end" else [0.0, 0.0, 3.4]])
    known = moved(tube.V, tube.F, W, joints, np.array([-1, 0, 1]), swings(24, 3, 20))
    middle = int(np.argmin(np.linalg.norm(known.V - [1.0, 0.0, 0.0], axis=1)))
    leaves = (middle,) if has_leaf else ()
    assert tuple(d.reason for d in of(known, leaves).dropped if d.part == 2) == dropped

    body, parts = (
        MovingSurface(known.V, known.F, known.x, known.area),
        MovingParts(known.label, known.R, known.t, known.residual),
    )
    found = part_tree(body, parts)
    state = Pruned(parts, found, found, np.arange(3), ())
    after = without_flat_ends(body, state, np.array(leaves, dtype=np.int64), PRUNING.flat)
    assert tuple(d.reason for d in after.dropped) == dropped
    assert after.parts.label.max() == 2 - len(dropped)
    assert (after is state) == (not dropped)


@pytest.mark.parametrize(("slide", "dropped"), [(0.05, ()), (0.3, (SLIDING,))])
def test_last_part_that_slides_is_none_unless_it_has_a_leaf(slide: float, dropped: tuple[str, ...]) -> None:
    """At the larger slide turning moves the part by 1.2 drifts of its joint: 0.5 are asked for with a leaf, 3 without."""
    body = chain((2.5,), swings(24, 2, 30, axes=1))
    t = body.t.copy()
    t[:, 1] += slide * np.random.default_rng(0).normal(size=(24, 3))
    body = body._replace(t=t)
    tip = int(body.V[:, 2].argmax())
    assert [d.reason for d in of(body).dropped] == list(dropped)
    assert of(body, (tip,)).dropped == ()
