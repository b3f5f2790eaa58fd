"""All parts in one tree."""

import numpy as np
import pytest
import trimesh
from articulated import Known, chain, moved, swings, three_arms
from limbs import rotation, tube

from kinetree.tasks.numerics.structure.joint_rotations import turning_range
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree, joints_of, part_tree


def of(body: Known, takes: list[slice] | None = None) -> PartTree:
    parts = MovingParts(body.label, body.R, body.t, body.residual)
    return part_tree(MovingSurface(body.V, body.F, body.x, body.area, takes), parts)


def touching(body: Known) -> Known:
    """The second and the third arm of the pipe meet before its middle."""
    bridge = (body.label == 0) & (body.V[:, 0] < -1.0) & (np.abs(body.V[:, 2]) < 3.0)
    label, x = body.label.copy(), body.x.copy()
    label[bridge] = np.where(body.V[bridge, 1] > 0, 2, 3)
    for part in (2, 3):
        own = label == part
        x[:, own] = body.V[own] @ body.R[:, part].transpose(0, 2, 1) + body.t[:, part, None]
    return body._replace(label=label, x=x)


def parent_of(found: PartTree, part: int) -> int:
    order = found.tree.order.tolist()
    return int(order[found.tree.parents[order.index(part)]])


def test_links_of_a_chain_hang_on_each_other() -> None:
    body = chain((-2.5, 0.0, 2.0))
    found = of(body)
    beside = {(int(found.tree.order[k]), int(found.tree.order[p])) for k, p in enumerate(found.tree.parents) if p >= 0}
    assert {frozenset(pair) for pair in beside} == {frozenset((k, k + 1)) for k in range(3)}
    assert found.joints.rest[found.tree.border[1:]] == pytest.approx(
        np.array([body.joints[max(pair)] for pair in sorted(beside, key=lambda p: found.tree.order.tolist().index(p[0]))]),
        abs=1e-3,
    )
    assert found.degrees[1:].min() > 40
    assert found.ratio[0] == np.inf


def test_arms_hang_on_the_middle() -> None:
    found = of(three_arms())
    assert found.tree.order[0] == 0
    assert found.tree.parents.tolist() == [-1, 0, 0, 0]


def test_ring_of_parts_is_cut_open_and_loses_none() -> None:
    mesh = trimesh.creation.torus(4.0, 1.0, major_sections=48, minor_sections=12)
    V, F = np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)
    label = np.floor((np.arctan2(V[:, 1], V[:, 0]) + np.pi) / (np.pi / 2 + 1e-9)).astype(np.int64)
    joints = np.array([[4 * np.cos(a), 4 * np.sin(a), 0] for a in -np.pi + np.pi / 2 * np.arange(4)])
    body = moved(V, F, np.eye(4)[label], joints, np.array([-1, 0, 1, 2]), swings(20, 4, 10))
    found = of(body)
    assert sorted(found.tree.order) == [0, 1, 2, 3]
    assert (found.tree.parents < np.arange(4)).all()


def test_part_that_meets_no_other_hangs_on_the_nearest() -> None:
    one = chain((0.0,))
    V, F = tube(12, 20)
    V = np.concatenate([one.V, V * 0.2 + [0.0, 0.0, 8.0]])
    F = np.concatenate([one.F, F + len(one.V)])
    label = np.concatenate([one.label, np.full(len(V) - len(one.V), 2)])
    joints = np.concatenate([one.joints, [[0.0, 0.0, 6.0]]])
    found = of(moved(V, F, np.eye(3)[label], joints, np.array([-1, 0, 1]), swings(20, 3)))
    place = found.tree.order.tolist().index(2)
    assert found.tree.order[found.tree.parents[place]] == 1


def test_joint_that_one_take_turns_is_as_clear_as_in_that_take() -> None:
    turn = np.tile(np.eye(3), (48, 2, 1, 1))
    turn[18:22, 1] = swings(4, 1, 15)[:, 0]
    body = chain((0.0,), turn)
    takes = [slice(0, 16), slice(16, 24), slice(24, 48)]
    whole, judged = of(body), of(body, takes)
    own = slice(16, 24)
    alone = of(body._replace(x=body.x[own], R=body.R[own], t=body.t[own]))
    assert judged.degrees[1] == pytest.approx(turning_range(turn[own, 1], 48))
    assert judged.ratio[1] == pytest.approx(alone.ratio[1], rel=0.05)
    assert whole.degrees[1] < 0.7 * judged.degrees[1] < judged.degrees[1] < alone.degrees[1]
    assert whole.ratio[1] < 0.7 * alone.ratio[1]
    assert of(body, [slice(0, 48)]).ratio[1] == whole.ratio[1]


def test_a_limb_that_one_take_turns_hangs_on_the_middle_and_not_on_the_limb_that_it_touches() -> None:
    """In all frames together two frames turn it, which may be wrong: only where it touches a turning limb is a joint then."""
    turn = swings(24, 4)
    turn[:, 2] = np.eye(3)
    turn[12:14, 2] = rotation((0.0, 0.0, 1.0), 0.3)
    body = touching(three_arms(turn))
    assert parent_of(of(body, [slice(0, 10), slice(10, 16), slice(16, 24)]), 2) == 0
    assert parent_of(of(body), 2) == 3


def test_limbs_that_move_alike_hang_on_the_middle_and_not_on_each_other() -> None:
    """Both carry the same error against the middle, so that the border in which they touch drifts least."""
    hinge = np.array([0.0, 1.0, 0.0])
    turn = np.tile(np.eye(3), (24, 4, 1, 1))
    turn[:, 2] = turn[:, 3] = np.stack([rotation(hinge, 0.5 * np.sin(f / 3)) for f in range(24)])
    turn[:, 1] = swings(24, 2)[:, 1]
    body = three_arms(turn)
    alike = np.cumsum(np.random.default_rng(0).normal(size=(24, 1, 3)), axis=0) * [0.05, 0.3, 0.05]
    body.t[:, 2:] += alike
    found = of(touching(body))
    assert found.tree.order[0] == 0
    assert found.tree.parents.tolist() == [-1, 0, 0, 0]


def test_parts_that_are_joined_have_a_joint_whatever_their_motions_say() -> None:
    """Both arms swing by themselves, so that the border between them drifts most."""
    body = touching(three_arms())
    parts = MovingParts(body.label, body.R, body.t, body.residual)
    surface = MovingSurface(body.V, body.F, body.x, body.area)
    free, hung = joints_of(part_tree(surface, parts)), frozenset((2, 3))
    assert hung not in free
    for asked in (frozenset({hung}), free - {frozenset((0, 3))} | {hung}):
        assert asked <= joints_of(part_tree(surface, parts._replace(joined=asked)))


def test_a_part_that_goes_takes_its_pairs_along_and_the_others_are_numbered_anew() -> None:
    body = three_arms()
    pairs = frozenset({frozenset((1, 3)), frozenset((0, 2)), frozenset((0, 1))})
    left = MovingParts(body.label, body.R, body.t, body.residual, joined=pairs, by_shape=pairs - {frozenset((0, 1))})
    fewer = left.without(2, np.where(body.label == 2, 0, body.label))
    assert fewer.joined == {frozenset((1, 2)), frozenset((0, 1))}
    assert fewer.by_shape == {frozenset((1, 2))}
