"""Laws of fitting a body to one frame."""

import numpy as np
import pytest
from fitting import arms, surface_at, tip, true, turned
from limbs import rotation

from kinetree.tasks.numerics.structure.articulated_frame import relative_rotations
from kinetree.tasks.numerics.structure.surface_fit import aligned_weight, fitted_to_surface, surface_support
from kinetree.tasks.numerics.structure.surface_matches import equations, searched

FRAME = 5


def test_body_is_drawn_onto_the_surface_without_any_aligned_vertex() -> None:
    known, body = arms()
    at = true(known, FRAME)
    start = turned(at, 1, rotation((0.0, 0.0, 1.0), 0.4))
    expected = relative_rotations(start.R, body.parents)
    found = fitted_to_surface(body, start, surface_at(known, body, FRAME), known.x[FRAME], np.zeros(len(known.V)), expected)
    assert np.linalg.norm(tip(body, found, 1) - tip(body, at, 1)) < 0.01 * body.size


def test_arm_that_the_frame_lost_is_held_where_it_was_expected() -> None:
    known, body = arms()
    at = true(known, FRAME)
    target = surface_at(known, body, FRAME, lost=1)
    surface = equations(body, target, searched(body, at, target), 0.02 * body.size, 0.05)
    support = surface_support(body, surface)
    assert support[1] < 0.3 < 0.7 < support[[0, 2, 3]].min()
    expected = relative_rotations(at.R, body.parents)
    found = fitted_to_surface(body, at, target, known.x[FRAME], np.zeros(len(known.V)), expected)
    assert np.linalg.norm(tip(body, found, 1) - tip(body, at, 1)) < 0.01 * body.size


def test_faint_vertices_and_those_of_parts_hardly_seen_weigh_nothing() -> None:
    known, body = arms()
    confidence, sure = np.ones(len(known.V)), np.ones(4)
    confidence[:7], sure[2] = 0.5, 0.0
    weight = aligned_weight(body, confidence, sure)
    assert (weight[:7] == 0.0).all()
    assert (weight[body.label == 2] == 0.0).all()
    assert weight[7:][body.label[7:] != 2] == pytest.approx(1.0)
