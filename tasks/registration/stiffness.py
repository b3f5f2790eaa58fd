"""How stiff every tie of the deformation graph is, learned from all frames, three times."""

from collections.abc import Iterable
from typing import TypeVar

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.pose import Pose
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.refit import SecondRefit
from kinetree.schemas.registration.rigid_clusters import RigidClusters
from kinetree.schemas.registration.roll_correction import RollCorrection
from kinetree.schemas.registration.roll_path import RollPath
from kinetree.schemas.registration.stiffness import FirstStiffness, SecondStiffness, Stiffness, ThirdStiffness
from kinetree.tasks.numerics.registration.stiffness import freed, learned, loosened
from kinetree.tasks.registration.pose import graph, pose

S = TypeVar("S", bound=Stiffness)


@task()
def first_stiffness(template: DeformationGraph, repair: tuple[Recovery, ...]) -> FirstStiffness:
    """Learns from the tracked poses which ties bend (ours)."""
    return _learned(FirstStiffness, template, repair)


@task()
def second_stiffness(template: DeformationGraph, refit: tuple[RollCorrection, ...], twist: RollPath) -> SecondStiffness:
    """Learns again from the first refit, in which limbs got their twist back (ours)."""
    return _learned(SecondStiffness, template, refit, twist)


@task()
def third_stiffness(
    template: DeformationGraph, refit: tuple[SecondRefit, ...], twist: RollPath, pieces: RigidClusters
) -> ThirdStiffness:
    """Learns again from the second refit, and lets pieces turn against each other more freely (ours)."""
    found = _learned(ThirdStiffness, template, refit, twist)
    if not len(template.nodes):
        return found
    return ThirdStiffness(stiffness=loosened(graph(template), found.stiffness, pieces.label.astype(np.int64)))


def _learned(cls: type[S], template: DeformationGraph, poses: Iterable[Pose], twist: RollPath | None = None) -> S:
    if not len(template.nodes):
        return cls(stiffness=np.empty(0))
    body = graph(template)
    found = learned(body, [pose(p) for p in poses])
    return cls(stiffness=found if twist is None else freed(body, found, twist.limb.astype(np.int64)))
