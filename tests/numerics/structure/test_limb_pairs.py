"""Which ends of limbs are a pair."""

import numpy as np
import pytest
from limbs import tube

from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs

V, F = tube(20, 40, flat=1.0)
LOW, HIGH = int(V[:, 2].argmin()), int(V[:, 2].argmax())


def at(z: float) -> int:
    return int(np.argmin(np.linalg.norm(V - [1.0, 0.0, z], axis=1)))


def tips(pairs: LimbPairs) -> list[set[int]]:
    return [set(pair) for pair in pairs.tip.tolist()]


def test_ends_that_lie_equally_far_from_a_third_are_a_pair() -> None:
    found = limb_pairs(V, F, np.array([LOW, at(0.0), HIGH]))
    assert tips(found) == [{LOW, HIGH}]
    for tip, distance in zip(found.tip[0], found.distance[0], strict=True):
        assert distance[tip] == 0.0
        assert distance[at(0.0)] == pytest.approx(5.0 + np.pi / 2 - 1.0, rel=0.02)


@pytest.mark.parametrize(("z", "paired"), [(0.2, True), (1.5, False)])
def test_ends_that_do_not_are_none(z: float, paired: bool) -> None:
    """Exchanged, they change distances by 0.03 and 0.23 of the longest."""
    assert bool(tips(limb_pairs(V, F, np.array([LOW, at(z), HIGH])))) == paired


def test_ends_on_other_pieces_and_lonely_ones_are_none() -> None:
    far = np.concatenate([V, 0.1 * V + 20.0])
    both = np.concatenate([F, F + len(V)])
    assert tips(limb_pairs(far, both, np.array([LOW, HIGH, LOW + len(V), HIGH + len(V)]))) == [{LOW, HIGH}]
    assert not len(limb_pairs(far, both, np.array([LOW, HIGH + len(V)])).tip)
    assert limb_pairs(V, F, np.zeros(0, np.int64)).distance.shape == (0, 2, len(V))
