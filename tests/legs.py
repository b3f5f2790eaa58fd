"""A pelvis with a chest and two legs of a thigh and a shank each: a pipe of three arms, in the parts that a test asks for."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Self

import numpy as np
from limbs import rotation
from shapes import y_pipe

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface, surface_areas
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_motion import fit, residuals
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface

V, F, _ = y_pipe()
"""The chest along x, legs at 60° on either side of −x."""
FRAMES = 16
HIP, KNEE, WAIST, FOOT = 4.0, 15.0, 8.0, 21.0
"""Distances of the joints from the fork; feet move as shanks, and are of their part if nothing else is said."""
LEGS = {"left": np.array([-0.5, np.sqrt(0.75), 0.0]), "right": np.array([-0.5, -np.sqrt(0.75), 0.0])}
ALONG = {side: V @ leg for side, leg in LEGS.items()}
LEFT, RIGHT, HEAD = int(np.argmax(V[:, 1])), int(np.argmin(V[:, 1])), int(np.argmax(V[:, 0]))
LEAVES = np.array([LEFT, RIGHT, HEAD, int(np.argmin(np.linalg.norm(V - [16.0, 0.0, 4.0], axis=1)))])
NAMES = ("pelvis", "left thigh", "right thigh", "left shank", "right shank", "chest")


def pieces(hip: float = HIP) -> dict[str, Ints]:
    """The vertices of each bone; with the hips at 0 the thighs touch."""
    of = {"chest": np.flatnonzero(V[:, 0] > WAIST)}
    for side, along in ALONG.items():
        of[f"{side} thigh"] = np.flatnonzero((along > hip) & (along <= KNEE))
        of[f"{side} shank"] = np.flatnonzero(along > KNEE)
    return {"pelvis": np.setdiff1d(np.arange(len(V)), np.concatenate(list(of.values()))), **of}


def of_legs() -> LimbPairs:
    """Both legs as a pair."""
    tips = np.array([LEFT, RIGHT])
    return LimbPairs(tips[None], geodesic_distance(Surface.of(V, F), tips)[None])


class Legs(NamedTuple):
    """The body, the parts it was cut into, and by the names of its bones the (frame, 3, 3) turns they were given."""

    body: MovingSurface
    parts: MovingParts
    motion: dict[str, Floats]

    @classmethod
    def of(cls, part: Mapping[str, int] | None = None, still: Sequence[str] = (), hip: float = HIP) -> Self:
        """The legs, each bone of the part of its name; bones may be still against what they hang on."""
        number = dict(zip(NAMES, range(len(NAMES)), strict=True)) if part is None else part
        label, x, motion = np.zeros(len(V), np.int64), np.empty((FRAMES, *V.shape)), dict[str, Floats]()
        own = pieces(hip)
        for name, vertices in own.items():
            label[vertices] = number[name]
        for side, along in ALONG.items():
            label = np.where(along > FOOT, number.get(f"{side} foot", label), label)
        label = np.unique(label, return_inverse=True)[1].reshape(-1)
        x[:, own["pelvis"]], motion["pelvis"] = V[own["pelvis"]], np.tile(np.eye(3), (FRAMES, 1, 1))
        motion["chest"], waist = _turns(15.0, 5), np.array([WAIST, 0.0, 0.0])
        x[:, own["chest"]] = waist + (V[own["chest"]] - waist) @ motion["chest"].transpose(0, 2, 1)
        for k, (side, leg) in enumerate(LEGS.items()):
            thigh, shank = np.array([
                _turns(0.0 if f"{side} {bone}" in still else degrees, k + 2 * row)
                for row, (bone, degrees) in enumerate((("thigh", 20.0), ("shank", 30.0)))
            ])  # fmt: skip
            motion[f"{side} thigh"], motion[f"{side} shank"] = thigh, thigh @ shank
            knee = hip * leg + (KNEE - hip) * thigh @ leg
            x[:, own[f"{side} thigh"]] = hip * leg + (V[own[f"{side} thigh"]] - hip * leg) @ thigh.transpose(0, 2, 1)
            lower = (V[own[f"{side} shank"]] - KNEE * leg) @ (thigh @ shank).transpose(0, 2, 1)
            x[:, own[f"{side} shank"]] = lower + knee[:, None]
        count, area = int(label.max()) + 1, surface_areas(V, F)
        R, t, weight = np.empty((FRAMES, count, 3, 3)), np.empty((FRAMES, count, 3)), np.asfortranarray(np.ones(x.shape[:2]))
        fit(V, x, weight, area, label, np.ones(count, np.bool_), False, len(V), 1e-6, R, t)
        left = np.maximum(residuals(V, x, weight * area, R, t, label), 0.01)
        return cls(MovingSurface(V, F, x, area), MovingParts(label, R, t, left, np.ones((FRAMES, count))), motion)


def _turns(degrees: float, phase: int) -> Floats:
    """(frame, 3, 3) swings within the plane of the legs and out of it."""
    angle = np.radians(degrees) * np.sin(np.arange(FRAMES) + phase)
    return np.array([rotation((0.3, 0.3, 1.0), a) for a in angle])
