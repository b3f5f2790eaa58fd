"""The same figure with fixed connectivity: one mesh at rest, skinned to the joints and settled on the implicit surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.implicit import Cones, limb_distances, values


class SkinSettings(NamedTuple):
    """How a skin is bound to the limbs and settled on them."""

    width: float = 0.8
    """Distance beyond that to the nearest limb at which another limb has no weight left, share of its smallest radius."""
    settling_steps: int = 6
    """Steps along the gradient onto the implicit surface after linear blend skinning."""


_SETTINGS = SkinSettings()


@dataclass(frozen=True)
class Skin:
    """A mesh at rest with its weights.

    V, F    : (vertex, xyz), (face, corner)
    weights : (vertex, limb), rows sum to 1
    owner   : (vertex,) the limb that is nearest at rest
    """

    V: Floats
    F: Ints
    weights: Floats
    owner: Ints

    @classmethod
    def of(cls, flesh: Flesh, rest: Floats, V: Floats, F: Ints, width: float | None = None) -> Skin:
        """Smooth weights from the blend: a limb counts by how little farther it is than the nearest, on its own radius.

        It counts only through a limb that it blends with, so that a hand beside a thigh takes nothing from it.

        rest  : (joint, xyz) rest positions; V : (vertex, xyz) on the surface at rest
        width : as in the settings, which count when it is None
        """
        d = limb_distances(flesh.at(rest, np.tile(np.eye(3), (len(rest), 1, 1))), V)
        reach = (_SETTINGS.width if width is None else width) * flesh.table.min(axis=1)
        closeness = np.maximum(1.0 - (d - d.min(axis=1, keepdims=True)) / reach, 0.0) ** 2
        through = np.stack([(closeness * near).max(axis=1) for near in flesh.neighbours], 1)
        weights = closeness * through
        return cls(V, F, weights / weights.sum(axis=1, keepdims=True), np.argmin(d, axis=1).astype(np.int64))

    def posed(self, cones: Cones, flesh: Flesh, rest: Floats, X: Floats, G: Floats) -> Floats:
        """Vertices at a pose: linear blend skinning, then a few steps onto the surface of the limbs around the owner.

        Limbs that merely touch are left out of that surface, so that at a contact the skins press into each other
        as two skins do, and no vertex changes its limb.

        cones   : the limbs at that pose
        rest, X : (joint, xyz) at rest and posed; G : (joint, 3, 3) world rotations
        returns : (vertex, xyz)
        """
        V = np.zeros_like(self.V)
        for b, p in enumerate(flesh.parent):
            V += self.weights[:, b, None] * (X[p] + np.einsum("ij,vj->vi", G[p], self.V - rest[p]))
        near = (flesh.neighbours @ flesh.neighbours)[self.owner]
        for _ in range(_SETTINGS.settling_steps):
            f, g = values(cones, V, near)
            V -= f[:, None] * g
        return V
