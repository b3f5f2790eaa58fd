"""Rings across the trunk: between the part above and the limbs that hang on it, where they part no border."""

import numpy as np
import pytest
from smeared import END, turning
from trunk import LIMBS, MIRRORED, trunk

from kinetree.tasks.numerics.arrays import Ints
from kinetree.tasks.numerics.structure.end_cuts import EndCut
from kinetree.tasks.numerics.structure.trunk_cuts import TrunkCutsSettings, _are_of_trunk, trunk_cuts

BODY, TREE = trunk(turning(0.0))


def cuts(
    label: Ints = TREE.label,
    parents: Ints = TREE.parents,
    mirrored: tuple[int, ...] = MIRRORED,
) -> list[EndCut]:
    of_limbs = np.isin(np.arange(len(parents)), mirrored)
    rest = np.concatenate([TREE.rest, np.full((1, 3), 9.0)])[: len(parents)]
    return list(trunk_cuts(BODY.V, BODY.F, BODY.area, label, parents, rest, of_limbs))


def test_rings_lie_between_the_part_above_and_the_limbs() -> None:
    found = cuts()
    assert len(found) >= 3
    assert {(cut.part, cut.above, cut.hung) for cut in found} == {(0, 1, (2, 3))}
    heights = [cut.centre[2] for cut in found]
    assert heights == sorted(heights, reverse=True)
    assert heights[-1] > LIMBS
    assert heights[0] < END
    for cut in found:
        np.testing.assert_allclose(cut.centre[:2], 0.0, atol=0.05)
        assert (BODY.V[cut.own[cut.far], 2] < BODY.V[cut.own[~cut.far], 2].max()).all()


def test_seen_from_the_part_above_they_are_the_same() -> None:
    body, tree = trunk(turning(0.0), root=1)
    of_limbs = np.isin(np.arange(4), MIRRORED)
    found = list(trunk_cuts(body.V, body.F, body.area, tree.label, tree.parents, tree.rest, of_limbs))
    assert {(cut.part, cut.above, cut.hung) for cut in found} == {(1, 0, (2, 3))}
    assert [cut.centre[2] for cut in found] == pytest.approx([cut.centre[2] for cut in cuts()])


def test_a_part_with_two_neighbours_at_the_end_of_the_trunk_and_limbs_have_none() -> None:
    merged = np.where(TREE.label == 3, 2, TREE.label)
    assert cuts(merged, TREE.parents[:3]) == []
    assert cuts(mirrored=(0, 1, 2, 3)) == []
    assert cuts(mirrored=(1, 2, 3)) == []


@pytest.mark.parametrize(
    ("parents", "of_trunk"),
    [
        ([-1], []),
        ([-1, 0, 1, 2], []),
        ([-1, 0, 0, 0], [0]),
        ([-1, 0, 0, 0, 1, 4, 4], [0, 1, 4]),
        ([-1, 0, 0, 1, 1, 2, 2], [0, 1, 2]),
        ([-1, 0, 0, 0, 1, 4, 5, 5], [0, 1, 4, 5]),
        ([-1, 0, 0, 0, 1, 4, 5], [0]),
        ([-1, 0, 1, 1, 1], [1]),
        ([-1, 0, 1, 2, 3, 3], [3]),
        ([-1, 0, 0, 0, 1, 4, 5, 6, 6], [0, 1, 4, 5, 6]),
    ],
    ids=[
        "one",
        "chain",
        "fork",
        "abdomen",
        "abdomen that is the root",
        "two between",
        "tail",
        "beyond the root's end",
        "at the end of a chain",
        "three between",
    ],
)
def test_of_the_trunk_is_what_has_three_neighbours_or_lies_between_such(parents: list[int], of_trunk: list[int]) -> None:
    assert np.flatnonzero(_are_of_trunk(np.array(parents), np.zeros(len(parents), np.bool_), 3)).tolist() == of_trunk


def test_toes_of_a_limb_with_a_mirror_image_do_not_make_it_trunk() -> None:
    parents, limb = np.array([-1, 0, 0, 0, 3, 4, 5, 6, 6]), np.arange(9) >= 5
    assert np.flatnonzero(_are_of_trunk(parents, limb, 3)).tolist() == [0]
    assert np.flatnonzero(_are_of_trunk(parents, ~limb & limb, 3)).tolist() == [0, 3, 4, 5, 6]


def test_with_more_neighbours_asked_for_fewer_parts_are_of_the_trunk() -> None:
    label, parents, rest = TREE.label, TREE.parents, TREE.rest
    of = (BODY.V, BODY.F, BODY.area, label, parents, rest, np.isin(np.arange(4), MIRRORED))
    assert not list(trunk_cuts(*of, TrunkCutsSettings(neighbours=4)))
    assert list(trunk_cuts(*of, TrunkCutsSettings(neighbours=3)))


def test_rings_across_an_abdomen_lie_between_pelvis_and_chest() -> None:
    """Abdomen 0, chest 1 with limbs 5 and 6, pelvis 2 with limbs 3 and 4."""
    z, right = BODY.V[:, 2], BODY.V[:, 0] > 0.0
    low, high = (LIMBS + 1.0, END - 1.0)
    limbs = np.where(z < LIMBS, np.where(right, 3, 4), np.where(right, 5, 6))
    label = np.where((z < LIMBS) | (z > END), limbs, np.where(z < low, 2, np.where(z > high, 1, 0)))
    parents, rest = np.array([-1, 0, 0, 2, 2, 1, 1]), np.zeros((7, 3))
    rest[:, 2] = [0.0, high, low, LIMBS, LIMBS, END, END]
    found = list(trunk_cuts(BODY.V, BODY.F, BODY.area, label, parents, rest, np.arange(7) > 2))
    across = [cut for cut in found if cut.part == 0]
    assert {(cut.above, cut.hung) for cut in across} == {(1, (2,)), (2, (1,))}
    assert all(low < cut.centre[2] < high for cut in across)
    fewer = np.where(label == 6, 5, label)
    beside = list(trunk_cuts(BODY.V, BODY.F, BODY.area, fewer, parents[:6], rest[:6], np.arange(6) > 2))
    assert not any(cut.part == 0 for cut in beside)


def test_no_ring_parts_the_border_of_a_limb() -> None:
    V = BODY.V
    side = (V[:, 0] > 0.8) & (np.abs(V[:, 2]) < 2.0)
    beside = np.where(side & (TREE.label == 0), 4, TREE.label)
    heights = [cut.centre[2] for cut in cuts(beside, np.append(TREE.parents, 0), (2, 3, 4))]
    assert all(abs(z) > 0.5 for z in heights)
    assert any(abs(cut.centre[2]) < 0.5 for cut in cuts())


def test_how_far_rings_lie_from_joints_is_told() -> None:
    for cut in cuts():
        nearest = np.linalg.norm(TREE.rest[1:] - cut.centre, axis=1).min()
        assert cut.apart == pytest.approx(nearest / cut.radius)


def test_each_side_of_a_ring_is_one_piece() -> None:
    """From the middle of a tube rings go to both ends at once."""
    V = BODY.V
    label = np.where(np.abs(V[:, 2]) < 0.3, 1, np.where(V[:, 2] > END, 2, np.where(V[:, 2] < LIMBS, 3, 0)))
    assert cuts(label, np.array([-1, 0, 0, 0])) == []
