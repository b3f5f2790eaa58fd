"""Laws of the quality of an alignment."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2014.alignment_quality import alignment_quality

V, F = tube()
SIZE = float(np.sqrt(30.0))


def test_mesh_on_itself_has_no_residual_and_full_confidence_tracked_or_not():
    for tracked in (True, False):
        quality = alignment_quality(V, V, F, V, F, SIZE, tracked=tracked)
        np.testing.assert_allclose(quality.residual, 0.0, atol=1e-9)
        np.testing.assert_allclose(quality.stretch, 1.0)
        assert quality.confidence.min() > 0.99
        assert quality.uncovered == 0.0


def test_mesh_beside_the_frame_has_its_distance_as_residual_and_no_confidence():
    quality = alignment_quality(V, V + [100.0, 0.0, 0.0], F, V, F, SIZE, tracked=False)
    assert quality.residual.min() > 90.0
    assert quality.confidence.max() < 0.01
    assert quality.uncovered == 1.0


def test_tracked_vertices_are_exact_wherever_they_are():
    quality = alignment_quality(V, 2.0 * V, F, V, F, SIZE, tracked=True)
    assert quality.residual.tolist() == [0.0] * len(V)
    assert quality.confidence.tolist() == [1.0] * len(V)
    np.testing.assert_allclose(quality.stretch, 2.0)
