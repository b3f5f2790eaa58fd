"""What is true of the vertices of a generated sequence: the same body as one skinned mesh, by the sequence's recipe."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from kinetree.tasks.input.synth import body
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.input.synth.body import Body

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def skinned_motion(recipe: str, V: Floats, frames: Sequence[int], start: int) -> Floats:
    """(frame, vertex, xyz) where the true body carries the points of its surface that are nearest to some vertices.

    recipe : of the sequence, as its `Source` has it
    V      : (vertex, xyz) vertices of one of its frames, mesh unit
    frames : numbers of the frames wanted
    start  : place of V's frame among them
    """
    skinned = _skinned(recipe)
    skin, F = np.stack([skinned.frame(t)[0] for t in frames]), skinned.skin.F
    on = projected(V, skin[start], F)
    return np.asarray(np.einsum("vk,tvkx->tvx", on.share, skin[:, F[on.face]]))


def parts(recipe: str, V: Floats, frame: int) -> Ints:
    """(vertex,) the part of the true body that each vertex of a frame follows most."""
    return np.asarray(body(recipe).parts(frame, V))


def height(recipe: str) -> float:
    """Height of the body, mesh unit."""
    return float(body(recipe).figure.height)


def _skinned(recipe: str) -> Body:
    """The same body with one connectivity and nothing spoilt."""
    options: dict[str, Any] = json.loads(recipe)
    return body(json.dumps({**options, "connectivity": "fixed", "noise": 0.0, "holes": 0, "dropped": []}, sort_keys=True))
