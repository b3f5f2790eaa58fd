"""The default's reference as that of one interval."""

import numpy as np
import pytest
from sheets import CORNERS, aligned_reference_of, frame, reference_at

from kinetree.errors import ConfigError
from kinetree.schemas.paper_2014.interval_reference import IntervalReference

FRAMES = {t: frame(t) for t in (3, 5, 7)}


def reference_of(chosen: int, *, threshold: float = 0.2, ends: tuple[int, ...] = ()) -> IntervalReference:
    return aligned_reference_of(FRAMES, reference_at(FRAMES, chosen), threshold, ends)


@pytest.mark.parametrize("chosen", [3, 5, 7])
def test_it_is_the_mesh_of_the_chosen_frame_with_the_leaves_of_that_frame(chosen: int) -> None:
    reference, here = reference_of(chosen), FRAMES[chosen]
    assert (reference.frame, reference.frames) == (chosen, (3, 5, 7))
    np.testing.assert_array_equal(reference.vertices, here.mesh.vertices)
    assert set(reference.leaf_vertex.tolist()) == set(here.number[CORNERS].tolist())
    assert (reference.coordinates[np.arange(3), reference.leaf_vertex] == 0).all()
    np.testing.assert_allclose(np.sort(reference.coordinates, axis=0), np.sort(here.coordinates.distance, axis=0))
    column = (3, 5, 7).index(chosen)
    assert here.extrema.vertices[reference.extremum[:, column]].tolist() == reference.leaf_vertex.tolist()
    assert (np.delete(reference.extremum, column, axis=1) == -1).all()


def test_extrema_below_the_threshold_are_no_leaves() -> None:
    assert len(reference_of(5, threshold=0.49).leaf) == 3
    assert reference_of(5, threshold=0.51).coordinates.shape[0] == 0


def test_a_sequence_that_is_cut_is_refused_in_words() -> None:
    with pytest.raises(ConfigError, match=r"cut into 2 intervals.*intervals\.threshold to -1"):
        reference_of(5, ends=(0,))
