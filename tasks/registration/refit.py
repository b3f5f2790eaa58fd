"""Every frame fitted again by itself, with the stiffness the sequence taught, three times."""

from typing import TypeVar

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.pose import Pose
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.refit import FirstRefit, SecondRefit, ThirdRefit
from kinetree.schemas.registration.roll_correction import RollCorrection
from kinetree.schemas.registration.stiffness import FirstStiffness, SecondStiffness, Stiffness, ThirdStiffness
from kinetree.tasks.numerics.registration.deformation import FitSettings, fit
from kinetree.tasks.numerics.registration.stiffness import PASSES
from kinetree.tasks.registration.pose import graph, pose, target

P = TypeVar("P", bound=Pose)


@task(over="frame")
def first_refit(mesh: Mesh, template: DeformationGraph, repair: Recovery, stiffness: FirstStiffness) -> FirstRefit:
    """Fits a frame again, stiff where the sequence never bent (ours)."""
    return _fitted(FirstRefit, mesh, template, repair, stiffness, PASSES[0])


@task(over="frame")
def second_refit(mesh: Mesh, template: DeformationGraph, refit: RollCorrection, stiffness: SecondStiffness) -> SecondRefit:
    """Fits a frame again, softer, with what the first refit taught (ours)."""
    return _fitted(SecondRefit, mesh, template, refit, stiffness, PASSES[1])


@task(over="frame")
def third_refit(mesh: Mesh, template: DeformationGraph, refit: SecondRefit, stiffness: ThirdStiffness) -> ThirdRefit:
    """Fits a frame a last time, with what the second refit taught (ours)."""
    return _fitted(ThirdRefit, mesh, template, refit, stiffness, PASSES[2])


def _fitted(
    cls: type[P], mesh: Mesh, template: DeformationGraph, start: Pose, stiffness: Stiffness, settings: FitSettings
) -> P:
    """The pose after one more pass; the reference stays what it is."""
    found = pose(start)
    if start.steps > 0 and len(template.nodes):
        found = fit(graph(template), found, target(mesh, template), settings, stiffness.stiffness.copy()).pose
    return cls(steps=start.steps, rotation=found.rotation, translation=found.translation)
