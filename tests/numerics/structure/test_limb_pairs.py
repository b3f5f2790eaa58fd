"""Which ends of limbs are a pair."""

import numpy as np
import pytest
from limbs import tube

from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs

V, F = tube(24, 40, flat=1.0)
LOW, HIGH = int(V[:, 2].argmin()), int(V[:, 2].argmax())


def at(z: float, degrees: float = 0.0) -> int:
    """The vertex nearest to a place on the side."""
    angle = np.deg2rad(degrees)
    return int(np.argmin(np.linalg.norm(V - [np.cos(angle), np.sin(angle), z], axis=1)))


def sides(z: float) -> list[int]:
    return [at(z), at(z, 180.0)]


def tips(pairs: LimbPairs) -> list[set[int]]:
    return [set(pair) for pair in pairs.tip.tolist()]


def test_ends_that_lie_equally_far_from_all_others_are_a_pair() -> None:
    found = limb_pairs(V, F, np.array([LOW, *sides(0.0), HIGH]))
    assert sorted(map(sorted, tips(found))) == sorted([sorted({LOW, HIGH}), sorted(sides(0.0))])
    row = tips(found).index({LOW, HIGH})
    for tip, distance in zip(found.tip[row], found.distance[row], strict=True):
        assert distance[tip] == 0.0
        assert distance[at(0.0)] == pytest.approx(5.0 + np.pi / 2 - 1.0, rel=0.02)


@pytest.mark.parametrize(("z", "paired"), [(0.2, True), (0.7, False)])
def test_ends_that_do_not_are_none(z: float, paired: bool) -> None:
    """Exchanged, they change distances by 0.03 and 0.10 of the longest."""
    assert ({LOW, HIGH} in tips(limb_pairs(V, F, np.array([LOW, *sides(z), HIGH])))) == paired


def test_of_three_alike_ends_none_is_the_mirror_image_of_another() -> None:
    """By chance two of them may be more alike than either is to the third."""
    for heights in ((3.0, 3.0, 3.0), (3.0, 3.2, 2.9), (2.8, 3.0, 3.2), (3.0, 2.5, 1.7)):
        around = [at(z, degrees) for z, degrees in zip(heights, (0.0, 120.0, 240.0), strict=True)]
        assert tips(limb_pairs(V, F, np.array([LOW, *around]))) == []


def test_a_third_end_that_is_clearly_another_hides_no_pair() -> None:
    around = [at(3.0), at(-1.0, 120.0), at(3.0, 240.0)]
    assert tips(limb_pairs(V, F, np.array([LOW, *around]))) == [{around[0], around[2]}]


@pytest.mark.parametrize("leaves", [[], [LOW], [LOW, HIGH], [LOW, HIGH, at(0.0)]], ids=len)
def test_bodies_of_three_ends_and_fewer_have_no_pairs(leaves: list[int]) -> None:
    found = limb_pairs(V, F, np.array(leaves, np.int64))
    assert (found.tip.shape, found.distance.shape) == ((0, 2), (0, 2, len(V)))


def test_ends_on_other_pieces_are_none() -> None:
    far, both = np.concatenate([V, 0.1 * V + 20.0]), np.concatenate([F, F + len(V)])
    own, all_ends = [LOW, *sides(0.0), HIGH], np.array([LOW, *sides(0.0), HIGH])
    found = limb_pairs(far, both, np.concatenate([all_ends, all_ends + len(V)]))
    assert set().union(*tips(found)) == set(own)
    assert np.isinf(found.distance[:, :, len(V) :]).all()
    assert np.isfinite(found.distance[:, :, : len(V)]).all()
