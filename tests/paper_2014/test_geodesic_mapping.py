"""The geodesic mapping from an interval's reference to its frames, as the task gives it."""

import numpy as np
import pytest
from sheets import CHANGING, SHEET, TRACKED, Frame, followed, frame

from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping, GeodesicMappingParams
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.paper_2014.geodesic_mapping import geodesic_mapping
from kinetree.tasks.paper_2014.interval_reference import interval_reference


def reference(frames: dict[int, Frame]) -> IntervalReference:
    return interval_reference(
        {t: f.mesh for t, f in frames.items()},
        {t: f.geodesics for t, f in frames.items()},
        {t: f.coordinates for t, f in frames.items()},
        *followed(frames, len(frames) - 1),
    )


def chain(frames: dict[int, Frame], params: GeodesicMappingParams) -> tuple[IntervalReference, dict[int, GeodesicMapping]]:
    """All frames, each after the one from which it is reached."""
    start = reference(frames)
    found: dict[int, GeodesicMapping] = {}
    for t in sorted(frames, key=lambda t: abs(t - start.frame)):
        before = start.previous(t)
        here = frames[t]
        found[t] = geodesic_mapping(
            start, here.coordinates, here.tips, CHANGING, None if before is None else found[before], params
        )
    return start, found


def misses(frames: dict[int, Frame], start: IntervalReference, found: dict[int, GeodesicMapping]) -> dict[int, int]:
    """Vertices of each frame that are not mapped onto themselves."""
    return {t: int((m.image[frames[start.frame].place] != frames[t].place).sum()) for t, m in found.items()}


@pytest.mark.parametrize("order", ["composed", "direct"])
def test_every_vertex_of_a_folding_sheet_is_found_in_every_frame(order: str) -> None:
    frames = {t: frame(t) for t in range(7)}
    start, found = chain(frames, GeodesicMappingParams.model_validate({"order": order}))
    assert misses(frames, start, found) == dict.fromkeys(frames, 0)
    assert max(m.away.max() for m in found.values()) < 1e-3


def test_leaf_that_is_hidden_for_a_while_counts_again_behind() -> None:
    frames = {t: frame(t, hidden=(2,) if t == 4 else ()) for t in range(7)}
    start, found = chain(frames, GeodesicMappingParams())
    missed = misses(frames, start, found)
    assert missed.pop(4) >= 0
    assert missed == dict.fromkeys(missed, 0)
    assert np.isfinite(found[4].place).all()


def test_frame_without_leaves_maps_nothing_and_the_next_one_goes_on() -> None:
    frames = {t: frame(t, hidden=(0, 1, 2) if t == 5 else ()) for t in range(7)}
    start, found = chain(frames, GeodesicMappingParams())
    assert (found[5].image == -1).all()
    assert np.isnan(found[5].away).all()
    assert misses(frames, start, found)[6] == 0


def test_tracked_vertices_are_their_own_images() -> None:
    frames = {t: frame(t, anew=False) for t in range(3)}
    start = reference(frames)
    here = frames[2]
    told = geodesic_mapping(start, here.coordinates, here.tips, TRACKED, None, GeodesicMappingParams())
    assert told.image.tolist() == list(range(len(SHEET)))
