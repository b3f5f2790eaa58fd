"""Laws of the confidence of vertices: 1 where the body is the frame, less where it is far, stretched, or on another limb."""

import numpy as np
import pytest
from limbs import LENGTH, tube

from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.vertex_confidence import VertexConfidenceSettings, vertex_confidence

SETTINGS = VertexConfidenceSettings()


@pytest.fixture(scope="module")
def rest():
    return tube()


def confidence_of(rest, x, V, F, usual=0.0):
    size = np.sqrt(2 * np.pi * LENGTH)
    n = smoothed_normals(x, rest[1])
    return vertex_confidence(rest[0], x, n, rest[1], Target.of(V, F, size), usual), size


def test_body_that_is_the_frame_has_full_confidence(rest):
    found, _ = confidence_of(rest, rest[0], *rest)
    assert found.confidence == pytest.approx(1.0)
    assert found.uncovered == 0
    assert found.round_trip == pytest.approx(0.0, abs=1e-9)


def test_distance_at_which_a_point_no_longer_covers_halves_confidence(rest):
    V, F = rest
    x = V.copy()
    size = np.sqrt(2 * np.pi * LENGTH)
    tip = V[:, 2].argmax()
    x[tip, 2] += SETTINGS.residual * size
    found, _ = confidence_of(rest, x, V, F)
    assert found.residual[tip] == pytest.approx(SETTINGS.residual * size)
    assert found.confidence[tip] <= 0.5
    assert np.median(found.confidence) > 0.99


def test_what_lies_on_another_limb_comes_back_elsewhere(rest):
    V, F = rest
    beside = V + [4.0, 0, 0]
    two, faces = np.concatenate([V, beside]), np.concatenate([F, F + len(V)])
    both = (two, faces)
    x = np.concatenate([V, V + 1e-3 * V])  # the second limb sits on the first
    found, size = confidence_of(both, x, two, faces)
    assert found.uncovered > 0.4
    assert found.round_trip.max() > SETTINGS.round_trip * size
    alone = np.where(found.round_trip > 3.0, found.confidence, 0.0)
    assert alone.max() < 0.1


def test_usual_holes_are_forgiven_and_more_than_usual_is_not(rest):
    V, F = rest
    other = np.concatenate([V, V[:40] + [50.0, 0, 0]]), np.concatenate([F, np.array([[len(V), len(V) + 1, len(V) + 2]])])
    found, _ = confidence_of(rest, V, *other)
    assert found.uncovered > SETTINGS.uncovered / 2
    forgiven, _ = confidence_of(rest, V, *other, usual=found.uncovered)
    assert forgiven.confidence.max() == pytest.approx(1.0)
    assert found.confidence.max() == pytest.approx(1 / (1 + (found.uncovered / SETTINGS.uncovered) ** 2))
