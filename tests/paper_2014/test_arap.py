"""An interval's reference deformed to a frame, as the task gives it."""

import numpy as np
import pytest
from sheets import CHANGING, TRACKED, followed, frame

from kinetree.schemas.paper_2014.arap import ArapParams
from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping, GeodesicMappingParams
from kinetree.tasks.paper_2014.arap import arap
from kinetree.tasks.paper_2014.geodesic_mapping import geodesic_mapping
from kinetree.tasks.paper_2014.interval_reference import interval_reference

FRAMES = {t: frame(t) for t in range(5)}
REFERENCE = interval_reference(
    {t: f.mesh for t, f in FRAMES.items()},
    {t: f.geodesics for t, f in FRAMES.items()},
    {t: f.coordinates for t, f in FRAMES.items()},
    *followed(FRAMES, 4),
)
ITSELF = geodesic_mapping(REFERENCE, FRAMES[2].coordinates, FRAMES[2].tips, CHANGING, None, GeodesicMappingParams())


def mapped(number: int) -> GeodesicMapping:
    here = FRAMES[number]
    return geodesic_mapping(REFERENCE, here.coordinates, here.tips, CHANGING, ITSELF, GeodesicMappingParams())


def test_reference_in_its_own_frame_is_itself_and_believed() -> None:
    told = arap(REFERENCE, ITSELF, FRAMES[2].mesh, CHANGING, ArapParams())
    np.testing.assert_allclose(told.vertices, REFERENCE.vertices, atol=1e-9)
    assert told.residual.max() < 1e-9
    assert told.uncovered == 0.0
    assert told.trust.min() > 0.99


@pytest.mark.parametrize("number", [1, 3])
def test_folding_sheet_is_followed_and_hardly_stretched(number: int) -> None:
    told = arap(REFERENCE, mapped(number), FRAMES[number].mesh, CHANGING, ArapParams(length=0.05))
    true = FRAMES[number].mesh.vertices[FRAMES[number].place]
    np.testing.assert_allclose(told.vertices[FRAMES[2].place], true, atol=0.1)
    assert told.stretch == pytest.approx(1.0, abs=0.05)


def test_frame_in_which_nothing_is_matched_shows_the_reference_and_says_so() -> None:
    nothing = GeodesicMapping(
        image=np.full(len(REFERENCE.vertices), -1), place=REFERENCE.distance, away=np.full(len(REFERENCE.vertices), np.nan)
    )
    far = frame(4, bend=0.6)
    told = arap(REFERENCE, nothing, far.mesh, CHANGING, ArapParams())
    np.testing.assert_array_equal(told.vertices, REFERENCE.vertices)
    assert told.uncovered > 0.3
    assert told.residual.max() > 1.0


def test_tracked_vertices_are_where_the_frame_has_them() -> None:
    told = arap(REFERENCE, ITSELF, FRAMES[4].mesh, TRACKED, ArapParams())
    np.testing.assert_array_equal(told.vertices, FRAMES[4].mesh.vertices)
    assert (told.residual == 0.0).all()
    assert (told.trust == 1.0).all()
