"""The default's alignment of one frame as the paper's Step III reads it."""

import numpy as np
from sheets import aligned_reference_of, exact, frame, reference_at

from kinetree.schemas.registration.alignment import Alignment
from kinetree.tasks.paper_2014.aligned_frame import aligned_frame

FRAMES = {t: frame(t) for t in (5, 7)}
REFERENCE = aligned_reference_of(FRAMES, reference_at(FRAMES, 5))


def test_vertices_and_what_is_told_of_them_are_those_of_the_alignment() -> None:
    alignment = exact(FRAMES[5].number, FRAMES[7])
    artifact = aligned_frame(REFERENCE, alignment, FRAMES[7].mesh)
    for name in set(Alignment.model_fields) & {"vertices", "residual", "stretch", "confidence", "uncovered"}:
        np.testing.assert_array_equal(getattr(artifact, name), getattr(alignment, name))
    assert not artifact.is_rigid


def test_a_body_that_does_not_move_is_told_to_be_rigid() -> None:
    still = frame(5, bend=0.15)
    assert aligned_frame(REFERENCE, exact(FRAMES[5].number, still), still.mesh).is_rigid
