"""Laws of rigid parts on bodies whose parts are known."""

from functools import partial

import numpy as np
import pytest
import shapes
import trimesh
from limbs import bent, rotation, tube
from shipped import PARTS

from kinetree.tasks.numerics.structure import rigid_parts as numerics

rigid_parts = partial(numerics.rigid_parts, settings=PARTS)

FRAMES = 8


def linked(*hinges, around=20, along=56):
    """A tube that bends at each hinge, out of phase, about x: V, F, x and the true part of every vertex."""
    V, F = tube(around, along)
    x = np.empty((FRAMES, *V.shape))
    for f in range(FRAMES):
        x[f] = V
        for k, z in reversed(list(enumerate(hinges))):
            x[f] = bent(x[f] - [0, 0, z], 0.6 * np.sin(0.9 * f + 1.3 * k), 0.1) + [0, 0, z]
    return V, F, x, np.searchsorted(np.array(hinges), V[:, 2])


def assert_parts_are(found, V, true):
    assert found.R.shape[1] == true.max() + 1
    for k in range(true.max() + 1):
        most = np.bincount(found.label[true == k]).argmax()
        inside = found.label == most
        assert (inside == (true == k)).mean() > 0.93


@pytest.mark.parametrize("hinges", [(0.0,), (-1.7, 1.6)])
def test_links_of_a_tube_are_its_parts(hinges):
    V, F, x, true = linked(*hinges)
    assert_parts_are(rigid_parts(V, F, x), V, true)


def test_arms_of_a_y_pipe_are_its_parts():
    V, F, _ = shapes.y_pipe(20, 4)
    angle = np.round(np.arctan2(V[:, 1], V[:, 0]) / (2 * np.pi / 3)).astype(int) % 3
    out = np.stack([np.cos(angle * 2 * np.pi / 3), np.sin(angle * 2 * np.pi / 3), 0 * angle], axis=1)
    along = (V * out).sum(axis=1)
    x = np.empty((FRAMES, *V.shape))
    for f in range(FRAMES):
        turn = 0.5 * np.sin(0.8 * f + 2 * angle)
        share = np.clip(along - 9, 0, 1)
        x[f] = V + (share * (along - 10) * (np.cos(turn) - 1) - share * V[:, 2] * np.sin(turn))[:, None] * out
        x[f, :, 2] += share * ((along - 10) * np.sin(turn) + V[:, 2] * (np.cos(turn) - 1))
    found = rigid_parts(V, F, x)
    assert_parts_are(found, V, np.where(along > 9.5, 1 + angle, 0))


def test_a_stiff_body_is_one_part_however_it_moves():
    V, F = tube(around=20, along=40)
    x = np.stack([V @ rotation((1, 1, f), 0.4 * f).T + [f, 0, -f] for f in range(FRAMES)])
    found = rigid_parts(V, F, x + 1e-4 * np.random.default_rng(0).normal(size=x.shape))
    assert found.R.shape[1] == 1
    assert found.rigid.min() > 0.99
    assert found.residual.max() < 3e-4


def test_motions_carry_the_reference_to_every_frame():
    V, F, x, _ = linked(0.0)
    found = rigid_parts(V + 100, F, x)
    sure = found.rigid > 0.99
    carried = np.einsum("fvij,vj->fvi", found.R[:, found.label], V + 100) + found.t[:, found.label]
    assert np.linalg.norm(carried - x, axis=2)[:, sure].max() < 0.15
    np.testing.assert_allclose(found.R @ np.swapaxes(found.R, 2, 3), np.broadcast_to(np.eye(3), found.R.shape), atol=1e-9)


def test_rigid_motion_of_the_whole_and_scale_change_no_label():
    V, F, x, _ = linked(-1.7, 1.6)
    here = rigid_parts(V, F, x)
    moved = 7 * np.stack([x[f] @ rotation((f, 1, 2), 0.5 * f).T + f for f in range(FRAMES)])
    there = rigid_parts(7 * V @ rotation((1, 0, 1), 1.0).T, F, moved)
    assert (here.label == there.label).mean() > 0.99


def test_the_order_of_vertices_changes_no_part():
    V, F, x, true = linked(-1.7, 1.6)
    order = np.random.default_rng(0).permutation(len(V))
    rank = np.argsort(order)
    assert_parts_are(rigid_parts(V[order], rank[F], x[:, order]), V[order], true[order])


def test_the_same_input_has_the_same_parts_to_the_bit():
    V, F, x, _ = linked(0.0)
    V.flags.writeable = x.flags.writeable = False
    one, other = rigid_parts(V, F, x), rigid_parts(V, F, x)
    for a, b in zip((*one[:-1], *one.cut), (*other[:-1], *other.cut), strict=True):
        np.testing.assert_array_equal(a, b)


def assert_every_initial_part_is_accounted_for(found):
    """Each part of the first cut is left, was removed once at too small a cost, or has lost its vertices."""
    cut = found.cut
    removed, origin = cut.removed.tolist(), cut.origin.tolist()
    assert len({*removed, *origin}) == len(removed) + len(origin)
    assert {*removed, *origin} <= set(range(int(cut.initial.max()) + 1))
    assert set(np.unique(cut.initial)) == set(range(int(cut.initial.max()) + 1))
    assert len(origin) == found.R.shape[1]
    assert (cut.cost < cut.cost_threshold).all()


def test_the_first_cut_is_too_fine_and_every_part_of_it_is_accounted_for():
    V, F, x, _ = linked(-1.7, 1.6)
    found = rigid_parts(V, F, x)
    assert_every_initial_part_is_accounted_for(found)
    assert found.cut.initial.max() + 1 > found.R.shape[1]
    for part, origin in enumerate(found.cut.origin):
        first = found.cut.initial == origin
        assert (found.label[first] == part).mean() > 0.5
    assert found.cut.cost_threshold >= 0.0025


def test_cones_of_the_first_cut_lie_around_their_tips():
    V, F, x, _ = linked(0.0)
    tips = np.array([int(V[:, 2].argmin()), int(V[:, 2].argmax())])
    cut = rigid_parts(V, F, x, leaves=tips).cut
    assert sorted(cut.tip) == sorted(tips)
    for k, tip in enumerate(cut.tip):
        assert (cut.cone[tip], cut.ring[tip]) == (k, 0)
        side = np.sign(V[tip, 2])
        assert (side * V[cut.cone == k, 2] > 0).all()
    assert ((cut.cone >= 0) == (cut.ring >= 0)).all()


def test_what_is_not_trusted_makes_no_part():
    V, F, x, true = linked(0.0)
    trust = np.ones(x.shape[:2])
    wrong = np.abs(V[:, 2] - 3) < 0.8
    x[2:5, wrong] += [1.5, 0, 0]
    trust[2:5, wrong] = 0.0
    assert rigid_parts(V, F, x).R.shape[1] > 2
    assert_parts_are(rigid_parts(V, F, x, trust), V, true)


def test_a_ring_and_a_body_without_leaves_have_parts():
    ring = trimesh.creation.torus(3.0, 0.8, major_sections=48, minor_sections=16)
    V, F = np.array(ring.vertices), np.array(ring.faces)
    x = np.stack([bent(V[:, [2, 1, 0]], 0.2 * f, 0.5)[:, [2, 1, 0]] for f in range(5)])
    found = rigid_parts(V, F, x)
    assert 2 <= found.R.shape[1] <= 6
    assert rigid_parts(V, F, np.stack([V] * 3)).R.shape[1] == 1
    assert rigid_parts(V, F, x, leaves=np.zeros(0, np.int64)).R.shape[1] >= 2
    assert rigid_parts(V, F, x, leaves=np.array([0])).R.shape[1] >= 2


def test_small_components_go_with_what_is_nearest():
    V, F, x, true = linked(0.0)
    ball, faces = shapes.sphere(1)
    eye = 0.2 * ball + [1.3, 0, 4]
    both = np.concatenate([V, eye])
    moved = np.concatenate(
        [x, np.stack([x[f][true == 1].mean(axis=0) + eye - eye.mean(axis=0) for f in range(FRAMES)])], axis=1
    )
    found = rigid_parts(both, np.concatenate([F, faces + len(V)]), moved)
    assert found.R.shape[1] == 2
    assert (found.label[len(V) :] == found.label[np.argmax(V[:, 2])]).all()


def test_one_frame_shows_no_parts():
    V, F, _, _ = linked(0.0)
    assert rigid_parts(V, F, V[None]).R.shape[1] == 1


def test_a_large_surface_asked_at_some_of_its_vertices_has_the_same_parts():
    V, F, x, true = linked(-1.7, 1.6, around=40, along=120)
    lone = np.array([[0.9, 0.0, 3.0], [0.9, 0.1, 3.0], [0.9, 0.0, 3.1]])
    F = np.concatenate([F, [[len(V), len(V) + 1, len(V) + 2]]])
    x = np.concatenate([x, np.tile(lone, (FRAMES, 1, 1))], axis=1)
    found = rigid_parts(np.concatenate([V, lone]), F, x, settings=PARTS._replace(most_vertices=2000))
    assert_parts_are(found, V, np.append(true, [2, 2, 2]))
    assert len(found.label) == len(found.rigid) == len(V) + 3
    assert len(found.cut.initial) == len(found.cut.cone) == len(found.cut.ring) == len(V) + 3
    assert (found.cut.ring[found.cut.tip] == 0).all()
    assert_every_initial_part_is_accounted_for(found)


def test_what_slides_along_the_surface_counts_only_where_every_vertex_was_followed():
    V, F = tube(around=24, along=56, flat=1.0)
    share = np.clip((V[:, 2] + 0.2) / 0.4, 0.0, 1.0)
    twist = 0.065 * np.sin(1.1 * np.arange(FRAMES))[:, None] * share
    x = np.stack([np.cos(twist) * V[:, 0] - np.sin(twist) * V[:, 1], np.sin(twist) * V[:, 0] + np.cos(twist) * V[:, 1]], 2)
    x = np.concatenate([x, np.tile(V[:, 2:], (FRAMES, 1, 1))], axis=2)
    assert rigid_parts(V, F, x).R.shape[1] == 2
    assert rigid_parts(V, F, x, np.ones(x.shape[:2])).R.shape[1] == 1


def test_limbs_that_move_alike_are_two_parts_of_one_origin():
    """Two arms of a Y-pipe turn about one line; the skin between them, in the corner, follows them by six tenths."""
    V, F, _ = shapes.y_pipe(20, 4)
    share = np.clip(-2.0 - V[:, 0], 0, 1) * np.clip(np.abs(V[:, 1]) / 4.0, 0.6, 1.0)
    x = np.empty((FRAMES, *V.shape))
    for f in range(FRAMES):
        turned = (V + [2.0, 0.0, 0.0]) @ rotation((0, 1, 0), 0.6 * np.sin(0.8 * f)).T - [2.0, 0.0, 0.0]
        x[f] = V + share[:, None] * (turned - V)
    found = rigid_parts(V, F, x)
    low, high = (np.bincount(found.label[(V[:, 0] < -4) & (side * V[:, 1] > 8)]).argmax() for side in (-1, 1))
    assert low != high
    assert found.cut.origin[low] == found.cut.origin[high]
    assert len(found.cut.origin) == found.R.shape[1]
