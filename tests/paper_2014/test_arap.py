"""An interval's reference deformed to a frame, as the task gives it."""

import numpy as np
import pytest
from sheets import TRACKED, frame, reference_of

from kinetree.schemas.paper_2014.arap import Arap, ArapParams, by_interval
from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping, GeodesicMappingParams
from kinetree.tasks.paper_2014.arap import arap
from kinetree.tasks.paper_2014.geodesic_mapping import geodesic_mapping

FRAMES = {t: frame(t) for t in range(5)}
REFERENCE = reference_of(FRAMES, 0, 4)
IDENTITY = geodesic_mapping((0, 2), REFERENCE, FRAMES[2].coordinates, None, GeodesicMappingParams())


def test_reference_in_its_own_frame_is_itself_with_full_confidence() -> None:
    artifact = arap(REFERENCE, IDENTITY, FRAMES[2].mesh, ArapParams())
    np.testing.assert_allclose(artifact.vertices, REFERENCE.vertices, atol=1e-9)
    assert artifact.residual.max() < 1e-9
    assert artifact.uncovered == 0.0
    assert artifact.confidence.min() > 0.99


@pytest.mark.parametrize("t", [1, 3])
def test_folding_sheet_is_followed_and_hardly_stretched(t: int) -> None:
    mapping = geodesic_mapping((0, t), REFERENCE, FRAMES[t].coordinates, IDENTITY, GeodesicMappingParams())
    artifact = arap(REFERENCE, mapping, FRAMES[t].mesh, ArapParams(length=0.05))
    true = FRAMES[t].mesh.vertices[FRAMES[t].number]
    np.testing.assert_allclose(artifact.vertices[FRAMES[2].number], true, atol=0.1)
    assert artifact.stretch == pytest.approx(1.0, abs=0.05)


def test_frame_in_which_no_vertex_has_an_image_has_the_reference_and_its_residual() -> None:
    count = len(REFERENCE.vertices)
    nothing = GeodesicMapping(
        image=np.full(count, -1), coordinates=REFERENCE.coordinates, coordinate_distance=np.full(count, np.nan)
    )
    far = frame(4, bend=0.6)
    artifact = arap(REFERENCE, nothing, far.mesh, ArapParams())
    np.testing.assert_array_equal(artifact.vertices, REFERENCE.vertices)
    assert artifact.uncovered > 0.3
    assert artifact.residual.max() > 1.0


def test_tracked_vertices_are_where_the_frame_has_them() -> None:
    frames = {t: frame(t, anew=False) for t in range(5)}
    artifact = arap(reference_of(frames, 0, 4, connectivity=TRACKED), IDENTITY, frames[4].mesh, ArapParams())
    np.testing.assert_array_equal(artifact.vertices, frames[4].mesh.vertices)
    assert (artifact.residual == 0.0).all()
    assert (artifact.confidence == 1.0).all()
    assert not artifact.is_rigid


def test_alignments_are_those_of_the_frames_of_each_interval() -> None:
    references = [reference_of(FRAMES, i, 1, 4) for i in (0, 1)]
    one = np.ones(1)
    alignments = [
        Arap(vertices=np.zeros((1, 3)), residual=one, stretch=one, confidence=one, uncovered=0.0, rigid_residual=float(t))
        for t in FRAMES
    ]
    groups = by_interval(alignments, references)
    assert [[int(a.rigid_residual) for a in group] for group in groups] == [[0, 1], [2, 3, 4]]
