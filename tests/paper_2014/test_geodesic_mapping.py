"""The geodesic mapping from an interval's reference to its frames, as the task gives it."""

import numpy as np
import pytest
from sheets import SHEET, TRACKED, Frame, frame, reference_of

from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping, GeodesicMappingParams
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.paper_2014.geodesic_mapping import geodesic_mapping


def mapped(frames: dict[int, Frame], params: GeodesicMappingParams) -> tuple[IntervalReference, dict[int, GeodesicMapping]]:
    """The mappings of all frames, outwards from the reference."""
    reference = reference_of(frames, 0, len(frames) - 1)
    mappings: dict[int, GeodesicMapping] = {}
    for t in sorted(frames, key=lambda t: abs(t - reference.frame)):
        previous = reference.previous(t)
        before = None if previous is None else mappings[previous]
        mappings[t] = geodesic_mapping((0, t), reference, frames[t].coordinates, before, params)
    return reference, mappings


def misses(frames: dict[int, Frame], reference: IntervalReference, mappings: dict[int, GeodesicMapping]) -> dict[int, int]:
    """How many vertices of each frame are not mapped onto themselves."""
    start = frames[reference.frame].number
    return {t: int((m.image[start] != frames[t].number).sum()) for t, m in mappings.items()}


@pytest.mark.parametrize("order", ["composed", "direct"])
def test_every_vertex_of_a_folding_sheet_is_found_in_every_frame(order: str) -> None:
    frames = {t: frame(t) for t in range(7)}
    reference, mappings = mapped(frames, GeodesicMappingParams.model_validate({"order": order}))
    assert misses(frames, reference, mappings) == dict.fromkeys(frames, 0)
    assert max(m.coordinate_distance.max() for m in mappings.values()) < 1e-3


def test_frames_are_known_by_their_numbers_and_not_by_their_positions() -> None:
    frames = {t: frame(t) for t in (10, 11, 13, 17, 18)}
    reference, mappings = mapped(frames, GeodesicMappingParams())
    assert misses(frames, reference, mappings) == dict.fromkeys(frames, 0)


def test_leaf_that_is_hidden_for_a_while_counts_again_afterwards() -> None:
    frames = {t: frame(t, hidden=(2,) if t == 4 else ()) for t in range(7)}
    reference, mappings = mapped(frames, GeodesicMappingParams())
    missed = misses(frames, reference, mappings)
    assert missed.pop(4) >= 0
    assert missed == dict.fromkeys(missed, 0)
    assert np.isfinite(mappings[4].coordinates).all()


def test_frame_without_leaves_maps_nothing_and_the_next_one_is_mapped() -> None:
    frames = {t: frame(t, hidden=(0, 1, 2) if t == 5 else ()) for t in range(7)}
    reference, mappings = mapped(frames, GeodesicMappingParams())
    assert (mappings[5].image == -1).all()
    assert np.isnan(mappings[5].coordinate_distance).all()
    assert misses(frames, reference, mappings)[6] == 0


def test_tracked_vertices_are_their_own_images() -> None:
    frames = {t: frame(t, anew=False) for t in range(3)}
    reference = reference_of(frames, 0, 2, connectivity=TRACKED)
    first = geodesic_mapping((0, 1), reference, frames[1].coordinates, None, GeodesicMappingParams())
    later = geodesic_mapping((0, 2), reference, frames[2].coordinates, first, GeodesicMappingParams())
    assert later.image.tolist() == list(range(len(SHEET)))
    assert (later.coordinate_distance == 0.0).all()
