"""Laws of parts whose rigid surface lies in two pieces."""

import numpy as np
import pytest
from limbs import rotation, tube
from shipped import PARTS

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.structure.elimination import NormalisedBody
from kinetree.tasks.numerics.structure.parted_limbs import PartedLimbsSettings, parted
from kinetree.tasks.numerics.structure.score_spans import score_spans

FRAMES = 8


def pieces(
    soft: tuple[float, float],
    sway: float = 1.0,
    label: Ints | None = None,
    unseen: tuple[float, float] = (0.0, 0.0),
    settings: PartedLimbsSettings | None = None,
) -> tuple[Floats, Ints, Ints]:
    """Heights of a tube that turns as one but for the skin between two heights, which sways · labels and origins."""
    V, F = tube(20, 56)
    turn = np.stack([rotation((1.0, 0.0, 0.0), 0.3 * f) for f in range(FRAMES)])
    low, high = soft
    swell = np.clip(np.minimum(V[:, 2] - low, high - V[:, 2]), 0.0, 1.0)
    own = V + sway * np.cos(np.arange(FRAMES))[:, None, None] * swell[:, None] * [1.0, 0.0, 0.0]
    area = surface_areas(V, F)
    size = np.sqrt(area.sum())
    weight = np.ones((FRAMES, len(V))) * ((V[:, 2] <= unseen[0]) | (V[:, 2] >= unseen[1]))
    moved = np.einsum("fxy,fvy->fvx", turn, own) / size
    body = NormalisedBody(
        V / size, vertex_normals(V, F), F, moved, weight, area / size**2, *rings(F, len(V)), score_spans(FRAMES, None)
    )
    of = np.zeros(len(V), np.int64) if label is None else label
    R = np.repeat(turn[:, None], of.max() + 1, axis=1)
    return V[:, 2], *parted(body, of, R, np.zeros((*R.shape[:2], 3)), PARTS.elimination.removal_cost, settings)


def test_two_limbs_that_move_alike_are_two_parts() -> None:
    z, label, origin = pieces((-2.0, 2.0))
    np.testing.assert_array_equal(origin, [0, 0])
    assert {frozenset(label[z < -1.0]), frozenset(label[z > 1.0])} == {frozenset({0}), frozenset({1})}


def test_skin_between_them_goes_to_the_nearer_one() -> None:
    z, label, _ = pieces((-2.0, 1.0))
    low = label[z.argmin()]
    assert (label[z < -0.8] == low).all()
    assert (label[z > -0.2] != low).all()


@pytest.mark.parametrize(("soft", "sway"), [((-2.0, 2.0), 0.0), ((1.0, 9.0), 1.0), ((2.6, 4.0), 1.0)])
def test_one_rigid_piece_and_one_with_a_small_one_beside_it_stay_whole(soft: tuple[float, float], sway: float) -> None:
    _, label, origin = pieces(soft, sway)
    np.testing.assert_array_equal(origin, [0])
    assert not label.any()


@pytest.mark.parametrize(("share", "parts"), [(0.4, 1), (0.2, 2)])
def test_skin_of_whose_motion_the_part_explains_a_third_joins_the_pieces(share: float, parts: int) -> None:
    """The softest skin between both ends is explained by so much."""
    V, F = tube(20, 56)
    square = PARTS.elimination.removal_cost**2 * (1.0 / share - 1.0) / 4.0 * surface_areas(V, F).sum()
    sway = np.sqrt(square / (np.cos(np.arange(FRAMES)) ** 2).mean())
    assert len(pieces((-2.0, 2.0), sway)[2]) == parts


def test_other_parts_keep_their_numbers() -> None:
    V, _ = tube(20, 56)
    before = (V[:, 2] > 3.5).astype(np.int64)
    _, label, origin = pieces((-2.0, 1.0), label=before)
    np.testing.assert_array_equal(origin, [0, 1, 0])
    np.testing.assert_array_equal(label == 1, before == 1)
    assert set(label[before == 0]) == {0, 2}


def test_skin_that_no_frame_shows_joins_no_pieces() -> None:
    _, _, origin = pieces((-2.0, 2.0), unseen=(-1.5, 1.5))
    np.testing.assert_array_equal(origin, [0, 0])


def test_two_pieces_that_are_small_on_the_body_stay_one_part() -> None:
    """A quarter of the part each, and one of them less than a twenty-fifth of the body."""
    V, _ = tube(20, 56)
    tip = (V[:, 2] > 3.7).astype(np.int64)
    _, label, origin = pieces((4.0, 4.65), label=tip, sway=3.0)
    np.testing.assert_array_equal(origin, [0, 1])
    np.testing.assert_array_equal(label, tip)
    np.testing.assert_array_equal(
        pieces((4.0, 4.65), label=tip, sway=3.0, settings=PartedLimbsSettings(limb=0.0))[2], [0, 1, 1]
    )
