"""Geodesic coordinates of one frame, as the task gives them."""

import numpy as np
import pytest
from sheets import CORNERS, SHEET, frame


def test_distance_of_every_vertex_to_every_extremum_in_the_order_of_the_extrema() -> None:
    here = frame(0)
    assert here.coordinates.extrema.tolist() == here.extrema.vertices.tolist()
    straight = np.linalg.norm(SHEET[CORNERS][:, None] - SHEET[None], axis=2)
    assert here.coordinates.distance[:, here.number] == pytest.approx(straight, rel=0.01)


def test_frame_without_extrema_has_no_coordinates() -> None:
    assert frame(0, hidden=(0, 1, 2)).coordinates.distance.shape == (0, len(SHEET))
