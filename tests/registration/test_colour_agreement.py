"""Colours count where they agree between the tracked frames, and people are told."""

import numpy as np
from stepwise import bodied, walk

from kinetree.pipeline import views
from kinetree.schemas.registration.colour_agreement import ColourAgreement
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.tasks.numerics.input.synth.paint import Paint
from kinetree.tasks.registration.colour_agreement import colour_agreement
from kinetree.tasks.registration.reference_colour import reference_colour
from kinetree.tasks.registration.refit import refit


def agreed(colours: dict[int, VertexColour]) -> ColourAgreement:
    made = walk()
    reference = reference_colour(made.reference, colours)
    return colour_agreement(made.deformation_graph, made.first_fit, made.recovery, made.mesh, colours, reference)


def patterned() -> dict[int, VertexColour]:
    """The walking human painted."""
    paint = Paint(bodied(), bodied(connectivity="fixed"), "patterned", 0.3, 0.01)
    seen = {t: paint.colours(t, np.array(m.vertices), m.faces) for t, m in walk().mesh.items()}
    return {t: VertexColour(colour=np.round(255 * c).astype(np.uint8)) for t, c in seen.items()}


def noise() -> dict[int, VertexColour]:
    rng = np.random.default_rng(0)
    shapes = {t: m.vertices.shape for t, m in walk().mesh.items()}
    return {t: VertexColour(colour=rng.integers(0, 256, shape, dtype=np.uint8)) for t, shape in shapes.items()}


def test_patterned_clothes_agree_and_that_is_said() -> None:
    found = agreed(patterned())
    assert found.frames == tuple(t for t in walk().mesh if t != walk().reference.frame)
    assert found.is_used
    assert (found.share > 0.5).all()
    assert "colours of the frames agree and hold the alignment" in views.remarks(found)[0]


def test_noise_does_not_agree_is_not_used_and_that_is_said() -> None:
    found = agreed(noise())
    assert not found.is_used
    assert not len(found.colour)
    assert "do not agree and are not used" in views.remarks(found)[0]


def test_without_colours_nothing_is_measured_and_nothing_said() -> None:
    found = agreed({t: VertexColour.none() for t in walk().mesh})
    assert found.frames == ()
    assert not found.is_used
    assert views.remarks(found) == ()


def test_pass_fits_by_colours_that_count_and_else_as_without() -> None:
    made = walk()
    t = next(t for t in made.mesh if t != made.reference.frame)
    told = made.mesh[t], made.deformation_graph, made.first_fit[t], made.recovery
    told = *told, made.stiffness[0], (), made.roll[0], None, (0, t)
    without = refit(*told)
    painted, plain = patterned(), noise()
    assert not np.array_equal(refit(*told, painted[t], agreed(painted)).translation, without.translation)
    assert np.array_equal(refit(*told, plain[t], agreed(plain)).translation, without.translation)
