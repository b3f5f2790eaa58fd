"""The first fit of a frame with all samples, from the near pose that tracking left: frame by frame, in no chain (ours)."""

from dataclasses import replace

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.tracking import Tracking, tracking

SKIPPED = 0.4
"""Share of the steps of a fit that a near pose spares."""


def first_fit(graph: DeformationGraph, near: Pose, target: Target, fitting: FitSettings, usual: float = 0.0) -> Tracking:
    """Fit a frame from a near pose by the last steps of a fit; where a limb stays uncovered, in other ways too (ours).

    graph   : of the reference mesh
    near    : pose to begin with
    target  : the frame
    fitting : how a frame is fitted from its neighbour's pose
    usual   : smallest share of any frame between the reference and this one that lies far from the body
    returns : Tracking as `tracking` gives it
    """
    return tracking(graph, None, near, target, last_steps(fitting), distant=usual)


def last_steps(fitting: FitSettings, skipped: float = SKIPPED) -> FitSettings:
    """A fit without its first steps: it begins as stiff, and reaches as far, as the whole fit does at its first step left.

    skipped : share of the steps
    """
    steps = max(round((1.0 - skipped) * fitting.steps), 1)
    share = (fitting.steps - steps) / max(fitting.steps - 1, 1)

    stiffness, reach, scale, point_weight = (
        (first * (last / first) ** share, last)
        for first, last in (fitting.stiffness, fitting.reach, fitting.scale, fitting.point_weight)
    )
    return replace(fitting, steps=steps, stiffness=stiffness, reach=reach, scale=scale, point_weight=point_weight, searches=1)
