"""Flesh that is not rigid: it comes after the bone it is on, and swells where the joint beyond it bends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.input.synth.descriptions import number, refuse_unknown
from kinetree.tasks.numerics.input.synth.implicit import Cones

STEP = 0.01
"""Seconds between the moments that accelerations are taken from, as second differences."""


@dataclass(frozen=True)
class Softness:
    """How soft the flesh of a figure is.

    frequency : of the flesh on its bone, 1/s; the lower, the farther it stays behind
    most      : how far it goes at most, share of the limb's mean radius
    bulge     : how much a limb swells in its middle when the joint beyond bends by a right angle, share of its radius
    skin      : width over which weights of a skinned mesh pass from limb to limb, share of the limb's smallest radius
    """

    frequency: float
    most: float
    bulge: float
    skin: float

    @classmethod
    def of(cls, where: str, row: Mapping[str, Any]) -> Softness:
        """Check softness written as data; raises FigureError at an unknown key or a number out of range."""
        refuse_unknown(where, row, ("frequency", "most", "bulge", "skin"))
        return cls(
            number(where, "frequency", row.get("frequency", 6.0), low=0.5, high=100.0),
            number(where, "most", row.get("most", 0.2), low=-1e-9, high=0.4),
            number(where, "bulge", row.get("bulge", 0.0), low=-1e-9, high=0.3),
            number(where, "skin", row.get("skin", 0.8), low=0.0, high=2.0),
        )

    def sag(self, ends: tuple[Ints, Ints], radius: Floats, before: Floats, now: Floats, after: Floats) -> Floats:
        """How far the middle of every limb stays behind: u = −a / (2πf)², the answer of a spring to slow shaking, limited.

        ends               : (limb,) and (limb,) joints at the limbs' ends; radius : (limb,) mean, the figure's unit
        before, now, after : (frame, joint, xyz) positions `STEP` seconds apart
        returns            : (frame, limb, xyz) across the limb, in the figure's unit
        """
        start, end = ends
        a = (before - 2.0 * now + after) / STEP**2
        u = -0.5 * (a[:, start] + a[:, end]) / (2.0 * np.pi * self.frequency) ** 2
        D = now[:, end] - now[:, start]
        u -= np.sum(u * D, axis=2, keepdims=True) / np.sum(D * D, axis=2, keepdims=True) * D
        most = self.most * radius[:, None] + 1e-12
        return np.asarray(u * most / (most + np.linalg.norm(u, axis=2, keepdims=True)), dtype=np.float64)

    def swelling(self, ends: tuple[Ints, Ints], R: Floats) -> Floats:
        """(frame, limb) by which share of its radius the middle of each limb swells: bulge · (1 − cos θ) of the joint beyond.

        ends : (limb,) and (limb,) joints at the limbs' ends; R : (frame, joint, 3, 3) rotations against the parent
        """
        start, end = ends
        cosine = 0.5 * (np.trace(R, axis1=2, axis2=3) - 1.0)
        carries = np.isin(end, start)
        return np.asarray(self.bulge * np.where(carries, 1.0 - cosine[:, end], 0.0), dtype=np.float64)


def softened(cones: Cones, sag: Floats, swelling: Floats) -> Cones:
    """Limbs whose axes bow by `sag` (limb, xyz) in their middles, and which swell there by `swelling` (limb,)."""
    along = np.sin(np.pi * np.linspace(0.0, 1.0, cones.table.shape[1]))
    bent = 4.0 * np.max(np.linalg.norm(sag, axis=1) / np.linalg.norm(cones.D, axis=1), initial=0.0)
    table = np.where(cones.table > 0.0, cones.table * (1.0 + swelling[:, None] * along), cones.table)
    steps = np.abs(np.diff(table, axis=1)).max(axis=1) * (table.shape[1] - 1) / np.linalg.norm(cones.D, axis=1)
    present = cones.table.max(axis=1) > 0.0
    slope = float(np.sqrt(1.0 + np.max(steps, initial=0.0, where=present) ** 2) * (1.0 + bent))
    return cones._replace(bow=sag, table=table, slope=max(slope, cones.slope))
