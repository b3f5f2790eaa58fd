"""Figures of synthetic sequences: a tree of joints, the radii of the limbs between them, and the curves that turn them.

A figure is data, so that a user can write one; this module checks the words and freezes them. In rest pose:

    name: gripper
    unit: mm
    joints:                                     # one root; every other joint names its parent
      - {name: palm, position: [0, 0, 0], radius: 60}
      - {name: knuckle, parent: palm, position: [0, 0, 150], radius: 30}
      - {name: tip, parent: knuckle, position: [0, 0, 300], radii: [30, 34, 20], flatten: 0.6, side: [1, 0, 0]}
    motions:                                    # the first by name is the one used when none is named
      nod:
        knuckle: [{axis: [1, 0, 0], amplitude: 30, frequency: 0.7, phase: 0.25}]

`radii` is the profile of the limb from the parent to the joint, evenly spaced; without it the limb runs from the
parent's radius to the joint's. `keys: [[second, angle], …]` in place of an amplitude are postures; with a `period` they repeat.
`flatten` squeezes the limb to that share of its radius along `side`. `flesh: [0, -20, 0]` puts the middle of the limbs at a
joint that far off it: a spine is no middle of a trunk. Flesh is rigid unless
`softness: {frequency: 6, bulge: 0.05}` says how late it comes after its bone and how much it swells. Garments are listed as
`clothes`, each with its joints:

    - {name: skirt, from: [hips], to: [knee_l, knee_r], span: [0, 0.7], radii: [170, 110], folds: 8, depth: 0.06, lag: 0.1}
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetree.errors import FigureError
from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.input.synth.clothes import Garment
from kinetree.tasks.numerics.input.synth.descriptions import (
    Joint,
    Motion,
    mapping,
    number,
    read_joints,
    read_motion,
    refuse_unknown,
    suggestion,
)
from kinetree.tasks.numerics.input.synth.softness import Softness

_FIGURE_KEYS = ("name", "unit", "fps", "joints", "motions", "softness", "clothes")


@dataclass(frozen=True)
class Figure:
    """A checked figure: joints in an order in which every parent stands before its children, and named motions."""

    name: str
    unit: str
    fps: float
    joints: tuple[Joint, ...]
    motions: Mapping[str, Motion]
    softness: Softness | None = None
    clothes: tuple[Garment, ...] = ()

    @classmethod
    def of(cls, description: Mapping[str, Any]) -> Figure:
        """Check and freeze a figure that was written as data.

        raises : FigureError at an unknown key, an unknown or missing parent, two roots, a cycle, a number out of range
        """
        where = f"figure {description.get('name', '(no name)')!r}"
        refuse_unknown(where, description, _FIGURE_KEYS)
        entries = description.get("joints")
        if not isinstance(entries, Sequence) or isinstance(entries, str) or len(entries) < 2:
            raise FigureError(f"{where}: joints is {entries!r}, expected a list of at least two joints")
        joints = read_joints(where, entries)
        names = [joint.name for joint in joints]
        motions: dict[str, Motion] = {}
        for name, curves in mapping(where, "motions", description.get("motions", {"still": {}})).items():
            motions[str(name)] = read_motion(f"{where}, motion {name!r}", curves, names)
        fps = number(where, "fps", description.get("fps", 25.0), low=0.0)
        name, unit = str(description.get("name", "tree")), str(description.get("unit", "unknown"))
        softness = (
            Softness.of(where, mapping(where, "softness", description["softness"])) if "softness" in description else None
        )
        rows = description.get("clothes", ())
        if not isinstance(rows, Sequence) or isinstance(rows, str):
            raise FigureError(f"{where}: clothes is {rows!r}, expected a list of garments")
        ordered = [joint.name for joint in joints]
        clothes = tuple(Garment.of(where, mapping(where, "a garment", row), ordered) for row in rows)
        return cls(name, unit, fps, joints, motions, softness, clothes)

    @property
    def names(self) -> list[str]:
        """Names of the joints, in their order."""
        return [joint.name for joint in self.joints]

    @property
    def parents(self) -> Ints:
        """(joint,) index of the parent, −1 at the root."""
        return np.array([joint.parent for joint in self.joints], dtype=np.int64)

    @property
    def rest(self) -> Floats:
        """(joint, xyz) positions at rest, in the figure's unit."""
        return np.array([joint.position for joint in self.joints], dtype=np.float64)

    @property
    def flesh(self) -> Floats:
        """(joint, xyz) how far the middle of the limbs lies off each joint at rest, in the figure's unit."""
        return np.array([joint.flesh for joint in self.joints], dtype=np.float64)

    @property
    def height(self) -> float:
        """Largest extent of the balls around the joints at rest: the length errors are quoted against."""
        R = np.array([joint.radii[-1] for joint in self.joints])[:, None]
        return float(np.max((self.rest + R).max(axis=0) - (self.rest - R).min(axis=0)))

    def index(self, name: str, where: str) -> int:
        """Index of the joint of that name; FigureError with the nearest known name when there is none."""
        if name not in self.names:
            raise FigureError(f"{where}: figure {self.name!r} has no joint {name!r}{suggestion(name, self.names)}")
        return self.names.index(name)

    def below(self, joint: int) -> set[int]:
        """The joint and everything that hangs on it."""
        below = {joint}
        for j, p in enumerate(self.parents.tolist()):
            if p in below:
                below.add(j)
        return below

    def motion(self, name: str | None) -> Motion:
        """The motion of that name, or the first one; FigureError with the nearest known name when there is none."""
        known = list(self.motions)
        if name is not None and name not in self.motions:
            raise FigureError(f"figure {self.name!r} has no motion {name!r}{suggestion(name, known)}")
        return self.motions[name if name is not None else known[0]] if known else {}


def named(name: str, figures: Mapping[str, Mapping[str, Any]]) -> Figure:
    """The figure of that name among `figures` (name → description); FigureError suggesting the nearest known name."""
    if name not in figures:
        raise FigureError(f"there is no figure {name!r}{suggestion(name, figures)}")
    return Figure.of(figures[name])
