"""One frame fitted from its neighbour's pose with all samples, in several ways if needed.

A paw that moves farther than the distance to the next paw is matched to the wrong leg, and every later frame inherits
that. The share of the frame that the body leaves uncovered is then about ten times as large as in a good frame.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.registration.correspondence import CorrespondenceSettings, Target, uncovered
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose, bending, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs, clearly_less_bent, swings


class TrackingSettings(NamedTuple):
    """When a frame is fitted again in another way, and how the other ways differ from the usual one."""

    uncovered: float = 0.004
    """Share of a frame that may stay uncovered beyond the usual; above it other ways are tried. Chosen on: not recorded."""
    distant: float = 0.003
    """Share of a frame far from the body that counts as a lost limb: lost limbs leave 0.006 and more, folds of cloth that
    open 0.0025 at most, on one clothed and four other captures."""
    distance: float = 3.0 * CorrespondenceSettings().covered
    """From which distance to the body a sample is far, share of √area; chosen together with `distant`."""
    reach: float = 0.16
    """Reach of matches in the first step of the wide ways, share of √area. Chosen on: not recorded."""
    scale: float = 0.08
    """Distance from the plane at which a match counts a quarter in that step, share of √area. Chosen on: not recorded."""
    bent: float = 1.4
    """How many times as much as the other ways' best a pose from swung limbs may bend. Chosen on a wolf and a ballet:
    with arms exchanged 1.7 times or more, right ones 0.9 to 1.1 times."""
    bent_more: float = 0.1
    """What it may bend beyond that, share of the area: where a limb is lost the other ways may not bend at all. Not varied."""
    as_well: float = 0.02
    """Share of a frame by which one place where the body may stand may cover less than another. Not varied."""
    steps: int = 24
    """Gauss–Newton steps of the stiff ways. Chosen on: not recorded."""
    stiffness: float = 1.0
    """λ of the first step of the stiff ways. Chosen on: not recorded."""
    solver_steps: int = 60
    """Conjugate-gradient steps in each step of the stiff ways, at most. Chosen on: not recorded."""


class Attempt(NamedTuple):
    """One way to fit a frame.

    settings : of the fit
    start    : from the neighbour's pose, or as if the body moved on as before
    """

    settings: FitSettings
    start: Literal["neighbour", "predicted"] = "neighbour"


class Tracking(NamedTuple):
    """A frame of the chain.

    pose      : Pose
    uncovered : share of the frame's surface that the body does not explain, 0 to 1
    attempt   : number of the way that was taken, 0 for the usual one
    """

    pose: Pose
    uncovered: float
    attempt: int


def tracking(
    graph: DeformationGraph,
    earlier: Pose | None,
    neighbour: Pose,
    target: Target,
    fitting: FitSettings,
    usual: float = 0.0,
    settings: TrackingSettings | None = None,
    *,
    distant: float = 0.0,
    limbs: FrameLimbs | None = None,
) -> Tracking:
    """Fit a frame from its neighbour's pose; if a limb stays uncovered, try other ways and take what covers most (ours).

    graph     : of the reference mesh
    earlier   : pose of the neighbour's own neighbour, from which to predict; None where there is none
    neighbour : pose of the neighbouring frame
    target    : the frame
    fitting   : of the usual way
    usual     : smallest share that any frame between the reference and this one leaves uncovered: holes of a capture
    distant   : smallest share of any such frame that is far from the body
    limbs     : of the body, and those that this frame shows; None where they are not known
    returns   : Tracking of the first way that leaves little uncovered, or little of the frame far from the body; where no way
                does, of the one that covers most
    """
    settings = settings or TrackingSettings()
    ways = attempts(fitting, settings)
    best = _attempted(graph, neighbour, target, ways[0].settings, 0)
    starts: dict[str, Pose | None] = {
        "neighbour": neighbour,
        "predicted": None if earlier is None else predicted(earlier, neighbour),
    }
    for number, way in enumerate(ways[1:], start=1):
        if not _is_lost(graph, best, target, usual, distant, settings):
            break
        start = starts[way.start]
        if start is not None:
            best = min(best, _attempted(graph, start, target, way.settings, number), key=lambda attempt: attempt.uncovered)
    if limbs is None or not _is_lost(graph, best, target, usual, distant, settings):
        return best
    return _by_limbs(graph, best, neighbour, limbs, target, fitting, settings)


def entered(
    graph: DeformationGraph,
    starts: Sequence[Pose],
    target: Target,
    fitting: FitSettings,
    usual: float = 0.0,
    settings: TrackingSettings | None = None,
    *,
    distant: float = 0.0,
    limbs: FrameLimbs | None = None,
) -> Tracking:
    """Fit a frame from each place where the body may stand, and take what bends it least of those that cover the frame (ours).

    A body is much like itself turned back to front, and then covers a frame nearly as well; but feet must be turned over.

    starts  : poses to begin with, at least one
    returns : Tracking; `graph`, `target`, `fitting`, `usual`, `distant` and `limbs` as in `tracking`
    """
    settings = settings or TrackingSettings()
    found = [tracking(graph, None, start, target, fitting, usual, settings, distant=distant, limbs=limbs) for start in starts]
    return _least_bent(graph, found, min(one.uncovered for one in found) + settings.as_well)


def attempts(usual: FitSettings, settings: TrackingSettings | None = None) -> tuple[Attempt, ...]:
    """The ways to fit a frame, in the order in which they are tried (ours).

    usual   : settings of the usual way
    returns : the usual way · from a predicted pose · with a wide reach · stiff with many steps · stiff and predicted
    """
    s = settings or TrackingSettings()
    wide = replace(usual, reach=(s.reach, usual.reach[1]), scale=(s.scale, usual.scale[1]))
    stiff = replace(wide, steps=s.steps, stiffness=(s.stiffness, usual.stiffness[1]), solver_steps=s.solver_steps)
    return Attempt(usual), Attempt(usual, "predicted"), Attempt(wide), Attempt(stiff), Attempt(stiff, "predicted")


def distant_share(graph: DeformationGraph, pose: Pose, target: Target, distance: float | None = None) -> float:
    """Share of a frame's samples farther from the body than a distance: a lost limb has many, a fold of cloth few (ours).

    graph    : of the reference mesh
    pose     : of the body in this frame
    target   : the frame
    distance : share of √area of the reference, that of `TrackingSettings` if not given
    returns  : 0 to 1
    """
    limit = TrackingSettings().distance if distance is None else distance
    to_body = projected(target.V[target.sample], shape(graph, pose)[0], graph.F).distance
    return float((to_body > limit * target.size).mean())


def predicted(earlier: Pose, last: Pose) -> Pose:
    """The pose after `last` if every node turns and shifts once more as from `earlier` to `last`."""
    turn = last.rotation @ earlier.rotation.transpose(0, 2, 1)
    return Pose(turn @ last.rotation, 2.0 * last.translation - earlier.translation)


def stepped_back(earlier: Pose, last: Pose, ahead: float) -> Pose:
    """The pose from which `predicted` goes on by a step of another length: as many times as long as from `earlier` to `last`.

    ahead : length of the step to come, in lengths of the step before
    """
    if ahead == 1.0:
        return earlier
    turn = Rotation.from_matrix(last.rotation @ earlier.rotation.transpose(0, 2, 1)).as_rotvec()
    back = Rotation.from_rotvec(-ahead * turn).as_matrix()
    return Pose(back @ last.rotation, last.translation - ahead * (last.translation - earlier.translation))


def _is_lost(
    graph: DeformationGraph, best: Tracking, target: Target, usual: float, distant: float, settings: TrackingSettings
) -> bool:
    """Whether much is uncovered and some of it far from the body."""
    if best.uncovered <= usual + settings.uncovered:
        return False
    return distant_share(graph, best.pose, target, settings.distance) > distant + settings.distant


def _by_limbs(
    graph: DeformationGraph,
    best: Tracking,
    neighbour: Pose,
    limbs: FrameLimbs,
    target: Target,
    fitting: FitSettings,
    settings: TrackingSettings,
) -> Tracking:
    """The frame fitted from swung limbs if that covers more and bends hardly more: exchanged limbs cover a frame, but bend."""
    number = len(attempts(fitting, settings))
    tried = [_attempted(graph, start, target, fitting, number) for start in swings(graph, neighbour, *limbs)]
    least = min((one.uncovered for one in tried), default=np.inf)
    if not least < best.uncovered:
        return best
    alike = [one for one in tried if one.uncovered <= least + settings.uncovered]
    found = alike[clearly_less_bent(graph, [one.pose for one in alike])]
    most = settings.bent * bending(graph, best.pose) + settings.bent_more * graph.size**2
    return found if bending(graph, found.pose) <= most else best


def _least_bent(graph: DeformationGraph, found: Sequence[Tracking], most: float) -> Tracking:
    """Of those that leave no more uncovered than `most`, the one whose graph bends least."""
    bent = [bending(graph, one.pose) if one.uncovered <= most else np.inf for one in found]
    return found[int(np.argmin(bent))]


def _attempted(graph: DeformationGraph, start: Pose, target: Target, settings: FitSettings, number: int) -> Tracking:
    """The result of one way of fitting."""
    pose = fit(graph, start, target, settings).pose
    return Tracking(pose, uncovered(*shape(graph, pose), graph.F, target), number)
