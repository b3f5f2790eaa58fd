"""The body as other programs expect it: upright and in their unit, in vertices, joints and motion alike (ours)."""

from typing import Literal, NamedTuple

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.results.glb import ASSUMED_FPS
from kinetree.schemas.structure.joint_names import CERTAIN_FRONT, JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.placement import Axis, guessed_metres, upright_rotation
from kinetree.tasks.numerics.results.units import METRES


class Placement(NamedTuple):
    """What is known or assumed of the input's coordinates, as `PlacedFile` states it."""

    up: Axis
    up_confidence: float
    metres: float
    metres_from: Literal["parameter", "unit", "size"]
    unknown_unit: str | None
    assumed_fps: float | None


def placement(skeleton: Skeleton, estimate: UpDirection, up: Axis | None = None, metres: float | None = None) -> Placement:
    """The up direction and the unit of the input.

    up     : axis that the user says points up; None: the one that was found
    metres : length of one unit that the user says; None: from the unit, or guessed from the body's longest side
    """
    assumed = ASSUMED_FPS if skeleton.fps is None else None
    direction = (estimate.up, estimate.confidence) if up is None else (up, 1.0)
    if metres is not None:
        return Placement(*direction, metres, "parameter", None, assumed)
    if skeleton.unit in METRES:
        return Placement(*direction, METRES[str(skeleton.unit)], "unit", None, assumed)
    guess = guessed_metres(float(np.ptp(skeleton.vertices, axis=0).max()))
    return Placement(*direction, guess, "size", skeleton.unit, assumed)


def placed(skeleton: Skeleton, rotation: Floats, scale: float) -> Skeleton:
    """The same body in rotated and scaled coordinates; its rotations are about the rotated axes.

    rotation : (row, xyz)
    scale    : new units of one old unit
    """
    Q = scale * rotation.T
    return skeleton.model_copy(
        update={
            "positions": skeleton.positions @ Q,
            "rotation": rotation @ skeleton.rotation @ rotation.T,
            "rest": skeleton.rest @ Q,
            "vertices": skeleton.vertices @ Q,
            "drift": skeleton.drift * scale,
        }
    )


def in_unit(
    skeleton: Skeleton,
    estimate: UpDirection,
    up: Literal["y", "z"],
    scale: float | None,
    unit: str,
    front: Floats | None = None,
) -> tuple[Skeleton, Placement]:
    """The same body with an axis up and in a unit, and what is known or assumed of the input.

    up    : axis of the result that points up
    scale : length in the result of one unit of the input; None: the result is in `unit`
    unit  : as in METRES
    front : (xyz,) direction that the body faces, which is brought to where programs look for it
    """
    known = placement(skeleton, estimate, metres=scale and scale * METRES[unit])
    return placed(skeleton, upright_rotation(known.up, up, front), scale or known.metres / METRES[unit]), known


def renamed(skeleton: Skeleton, joint_names: JointNames) -> Skeleton:
    """The same body with the names that people know."""
    return skeleton.model_copy(update={"names": joint_names.names})


def known_front(joint_names: JointNames) -> Floats | None:
    """(xyz,) direction that the body faces, where it is certain enough to rotate the body by it."""
    return np.array(joint_names.front) if joint_names.front_confidence >= CERTAIN_FRONT else None
