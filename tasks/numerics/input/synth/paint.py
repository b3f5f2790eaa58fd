"""Colours fixed to the skin of a generated figure: clothes with patterns, or plain ones; light and noise of every frame.

A pattern is a function of where a point lies at rest: sums of plane waves of random directions (a random field, Rice 1944).
A first field divides the body into areas of one colour each, a second one of five octaves makes patterns, a third one says
where there are any. Skin carries it to every frame: colours are those of its true points, whatever its vertices.
"""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.input.synth.body import Body

Clothes = Literal["patterned", "plain"]
_PAINT, _LIGHT, _GRAIN = 101, 102, 103
"""What colours draw random numbers for, each from a stream of its own, beside those of the body."""


class PaintSettings(NamedTuple):
    """What clothes look like; lengths are shares of the figure's height, colours are sRGB from 0 to 1."""

    waves: int = 24
    """Plane waves of each field."""
    area: float = 0.35
    """Wavelength of the field that divides the body into areas."""
    octaves: tuple[float, ...] = (0.4, 0.2, 0.1, 0.05, 0.025)
    """Wavelengths of patterns."""
    contrast: float = 0.09
    """Root mean square of a pattern's longest octave; those after it have 1/√2 of the one before."""
    edge: float = 0.15
    """How far two areas mix at their border, share of the spread of their fields."""
    areas: int = 4
    """Colours of areas."""
    light: float = 0.25
    """Largest share by which light of one side brightens or darkens at full illumination."""
    exposure: float = 0.2
    """Standard deviation of a frame's exposure at full illumination, natural logarithm."""


@dataclass(frozen=True)
class Paint:
    """The colours of one figure.

    body         : whose frames are painted
    skinned      : the same figure with fixed connectivity, which says where every point is at rest
    clothes      : patterned or plain
    illumination : how far light and exposure change from frame to frame, 0 to 1
    grain        : standard deviation of noise of every vertex's colour, sRGB
    """

    body: Body
    skinned: Body
    clothes: Clothes
    illumination: float
    grain: float

    def colours(self, t: int, V: Floats, F: Any, settings: PaintSettings | None = None) -> Floats:
        """(vertex, rgb) sRGB from 0 to 1 of a frame's mesh V (vertex, xyz), F (face, corner)."""
        settings = settings or PaintSettings()
        skin = self.skinned.skin
        on = projected(V, self.skinned.frame(t)[0], skin.F)
        rest = np.einsum("vk,vkx->vx", on.share, skin.V[skin.F[on.face]])
        colour = self.at_rest(rest, settings)
        light = np.random.default_rng([self.body.seed, _LIGHT, t])
        direction = light.normal(size=3)
        direction /= np.linalg.norm(direction)
        side = vertex_normals(V, np.asarray(F, dtype=np.int64)) @ direction
        exposure = np.exp(self.illumination * settings.exposure * light.normal())
        colour = colour * exposure * (1.0 + self.illumination * settings.light * side[:, None])
        noise = np.random.default_rng([self.body.seed, _GRAIN, t]).normal(size=colour.shape)
        return np.clip(colour + self.grain * noise, 0.0, 1.0)

    def at_rest(self, rest: Floats, settings: PaintSettings) -> Floats:
        """(point, rgb) of points on the skin at rest (point, xyz), without light and noise."""
        rng = np.random.default_rng([self.body.seed, _PAINT])
        u = rest / self.body.figure.height
        palette = 0.25 + 0.5 * rng.random((settings.areas, 3))
        fields = np.stack([_field(u, settings.area, settings.waves, rng) for _ in palette], axis=1)
        mixed = np.exp((fields - fields.max(axis=1, keepdims=True)) / settings.edge)
        mixed /= mixed.sum(axis=1, keepdims=True)
        if self.clothes == "plain":
            return np.tile(palette[0], (len(rest), 1))
        plain = mixed @ palette
        where = 1.0 / (1.0 + np.exp(-4.0 * _field(u, settings.area, settings.waves, rng)))
        pattern = sum(
            settings.contrast * 2.0 ** (-0.5 * k) * np.stack([_field(u, w, settings.waves, rng) for _ in range(3)], axis=1)
            for k, w in enumerate(settings.octaves)
        )
        return np.asarray(np.clip(plain + where[:, None] * pattern, 0.0, 1.0))


def _field(u: Floats, wavelength: float, waves: int, rng: np.random.Generator) -> Floats:
    """(point,) a random field of about this wavelength, root mean square 1, at points (point, xyz)."""
    direction = rng.normal(size=(waves, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    number = 2.0 * np.pi / (wavelength * rng.uniform(0.8, 1.25, waves))
    phase = rng.uniform(0.0, 2.0 * np.pi, waves)
    return np.asarray(np.cos(np.einsum("px,wx->pw", u, number[:, None] * direction) + phase).sum(axis=1) * np.sqrt(2.0 / waves))
