"""Colours of the reference are those of its frame."""

import numpy as np
from stepwise import walk

from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.tasks.registration.reference_colour import reference_colour


def colours(seed: int, rows: int) -> VertexColour:
    return VertexColour(colour=np.random.default_rng(seed).integers(0, 256, (rows, 3), dtype=np.uint8))


def test_colours_are_those_of_the_frame_that_the_reference_is_from() -> None:
    made = walk()
    seen = {t: colours(t, len(mesh.vertices)) for t, mesh in made.mesh.items()}
    assert np.array_equal(reference_colour(made.reference, seen).colour, seen[made.reference.frame].colour)


def test_where_nothing_is_fitted_or_the_frame_has_none_there_are_none() -> None:
    made = walk()
    seen = {t: colours(t, len(mesh.vertices)) for t, mesh in made.mesh.items()}
    assert not len(reference_colour(made.reference.model_copy(update={"fixed": True}), seen).colour)
    assert not len(reference_colour(made.reference, {**seen, made.reference.frame: VertexColour.none()}).colour)
