"""Laws of the distance to a mask's outline, on half planes, discs and masks that the image cuts."""

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from kinetree.tasks.numerics.input.mask_distance import cut_sides, mask_distance

ROWS, COLUMNS = np.mgrid[:120, :150]
DISC = np.hypot(ROWS - 61.3, COLUMNS - 70.8) < 40.0


def placed(distance, shape=DISC.shape):
    """The distances back in the image, NaN where nothing was kept."""
    whole = np.full(shape, np.nan)
    rows, columns = distance.values.shape
    column, row = distance.corner
    whole[max(row, 0) : row + rows, max(column, 0) : column + columns] = distance.values[max(-row, 0) :, max(-column, 0) :][
        : shape[0] - max(row, 0), : shape[1] - max(column, 0)
    ]
    return whole


def test_distance_is_that_of_the_exact_transform_as_far_as_it_reaches():
    away = placed(mask_distance(DISC, 6, 0.0))
    exact = np.where(DISC, distance_transform_edt(DISC) - 0.5, 0.5 - distance_transform_edt(~DISC))
    known = np.isfinite(away)
    assert known[DISC].all()
    np.testing.assert_allclose(away[known], np.clip(exact, -6, 6)[known], atol=1e-5)
    assert (exact[~known] < -6).all()


def test_smoothed_distance_is_that_to_the_true_circle_within_half_a_pixel():
    away = placed(mask_distance(DISC, 8, 1.0))
    true = 40.0 - np.hypot(ROWS - 61.3, COLUMNS - 70.8)
    near = np.abs(true) < 2
    assert np.abs(away - true)[near].max() < 0.5
    assert np.abs(away - true)[near].mean() < np.abs(placed(mask_distance(DISC, 8, 0.0)) - true)[near].mean()


def test_a_straight_edge_lies_halfway_between_pixels():
    away = placed(mask_distance(COLUMNS >= 70, 20, 1.5))
    np.testing.assert_allclose(away[60, 66:74], np.arange(66, 74) - 69.5, atol=1e-5)


@pytest.mark.parametrize("side", range(4))
def test_a_mask_at_the_border_of_its_image_is_cut_there_and_has_no_outline_there(side):
    limits = [COLUMNS < 50, ROWS < 50, COLUMNS > 100, ROWS > 100]
    inside = limits[side] & (np.abs(ROWS - 60) < 50 if side % 2 == 0 else np.abs(COLUMNS - 75) < 50)
    assert [n for n, cut in enumerate(cut_sides(inside)) if cut] == [side]
    distance = mask_distance(inside, 5, 0.0)
    middle = [(60, 0), (0, 75), (60, 149), (119, 75)][side]
    assert placed(distance)[middle] == 5.0
    assert distance.cut[side]


def test_a_mask_near_the_border_that_does_not_touch_it_is_not_cut():
    inside = (COLUMNS > 0) & (COLUMNS < 30) & (ROWS > 40) & (ROWS < 80)
    distance = mask_distance(inside, 5, 0.0)
    assert not any(distance.cut)
    assert distance.corner[0] < 0
    assert distance.values[:, 0].max() == -5.0
