"""Frames in which the body lost a limb: found by what it leaves uncovered, tried again otherwise and from the other side.

A paw that moves further than the distance to the next paw is matched to the wrong leg, and every later frame inherits
that. The share of the frame that no point of the body explains tells such a frame from a good one by a factor of ten.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.registration.correspondence import COVERED, Target, uncovered
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph

Floats = npt.NDArray[np.float64]

LOST = 0.004  # share of a frame that may stay uncovered without a second look
LIMB = 0.003  # share of a frame this far from the body that is a lost limb; folds of cloth stay uncovered, but near it
AWAY = 3.0 * COVERED  # share of the body's size


@dataclass(frozen=True)
class Attempt:
    """One way to fit a frame that the usual way lost.

    settings  : of the fit
    predicted : whether to start where the body would be if it moved on as before
    """

    settings: FitSettings
    predicted: bool = False


def attempts(settings: FitSettings) -> tuple[Attempt, ...]:
    """The usual way, then from a predicted pose, with a wide reach, and stiff with many steps, still and predicted."""
    wide = replace(settings, reach=(0.16, settings.reach[1]), scale=(0.08, settings.scale[1]))
    stiff = replace(wide, steps=24, stiffness=(1.0, settings.stiffness[1]), solves=60)
    return Attempt(settings), Attempt(settings, True), Attempt(wide), Attempt(stiff), Attempt(stiff, True)


class Tracked(NamedTuple):
    """A frame of the chain.

    pose      : Pose
    uncovered : share of the frame that the body does not explain
    attempt   : which way was taken
    """

    pose: Pose
    uncovered: float
    attempt: int


def tracked(
    template: DeformationGraph,
    before: Pose | None,
    last: Pose,
    target: Target,
    settings: FitSettings | None = None,
    usual: float = 0.0,
) -> Tracked:
    """Fit a frame from its neighbour's pose; if a limb stays uncovered, try the other ways and take what covers most.

    before  : the pose of the neighbour's neighbour, from which to predict; None where there is none
    last    : the pose of the neighbouring frame
    usual   : the least that any frame on the way here left uncovered: holes of a capture, which no way would cover
    returns : Tracked; the first way that leaves no more than LOST beyond the usual uncovered, or no more than LIMB of the
              frame AWAY from the body, else the best of all
    """
    ways = attempts(settings or FitSettings())
    best = _taken(template, last, target, ways[0].settings, 0)
    for number, way in enumerate(ways[1:], start=1):
        if best.uncovered <= usual + LOST or strayed(template, best.pose, target) <= LIMB:
            break
        if way.predicted and before is None:
            continue
        start = last if before is None or not way.predicted else predicted(before, last)
        best = min(best, _taken(template, start, target, way.settings, number), key=lambda found: found.uncovered)
    return best


def strayed(template: DeformationGraph, pose: Pose, target: Target) -> float:
    """Share of a frame further than AWAY from the body: a lost limb, where what is merely uncovered may be a fold."""
    distance = projected(target.V[target.sample], shape(template, pose)[0], template.F).distance
    return float((distance > AWAY * target.size).mean())


def predicted(before: Pose, last: Pose) -> Pose:
    """Every node turned and shifted once more as from `before` to `last`."""
    turn = last.rotation @ before.rotation.transpose(0, 2, 1)
    return Pose(turn @ last.rotation, 2.0 * last.translation - before.translation)


def _taken(template: DeformationGraph, start: Pose, target: Target, settings: FitSettings, number: int) -> Tracked:
    """One attempt and what it leaves uncovered."""
    pose = fit(template, start, target, settings).pose
    return Tracked(pose, uncovered(*shape(template, pose), template.F, target), number)
