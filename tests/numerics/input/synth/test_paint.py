"""Paint is fixed to the skin, and light changes from frame to frame."""

import json

import numpy as np

from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.input.synth import body, paint, recipe
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.input.synth.paint import Paint


def coloured(**params):
    """Every frame's mesh and colours, and the same skin in every frame."""
    written = recipe(SynthParams(frames=3, vertices=1500, **{"paint": "patterned", "grain": 0.0, **params}))
    painted = paint(written)
    assert isinstance(painted, Paint)
    meshes = [body(written).frame(t) for t in range(3)]
    return painted, meshes, [painted.colours(t, *mesh) for t, mesh in enumerate(meshes)]


def test_the_same_point_of_the_skin_has_the_same_colour_in_every_frame() -> None:
    painted, meshes, colours = coloured()
    first, last = (painted.skinned.frame(t)[0] for t in (0, 2))
    F = painted.skinned.skin.F
    on = projected(meshes[0][0], first, F)
    there = np.einsum("vk,vkx->vx", on.share, last[F[on.face]])
    near = projected(there, *meshes[2])
    carried = np.einsum("vk,vkx->vx", near.share, colours[2][meshes[2][1][near.face]])
    assert np.median(np.abs(carried - colours[0])) < 0.02
    assert np.abs(np.roll(carried, 300, axis=0) - colours[0]).mean() > 4 * np.abs(carried - colours[0]).mean()


def test_plain_clothes_have_one_colour_until_light_or_noise_change_it() -> None:
    assert np.ptp(coloured(paint="plain")[2][0], axis=0).max() < 1e-12
    assert 0.005 < coloured(paint="plain", grain=0.01)[2][0].std(axis=0).mean() < 0.02
    lit = coloured(paint="plain", illumination=1.0)[2]
    assert abs(lit[0].mean() - lit[1].mean()) > 0.001
    assert lit[0].std(axis=0).max() > 0.02


def test_a_recipe_without_paint_says_nothing_of_it() -> None:
    params = json.loads(recipe(SynthParams(illumination=0.5)))
    assert not {"paint", "illumination", "grain"} & set(params)
    assert paint(recipe(SynthParams())) is None
