"""How stiff every tie of the deformation graph is, learned from all frames, three times."""

from collections.abc import Iterable
from typing import TypeVar

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.pose import Pose
from kinetree.schemas.refit import FirstRefit, SecondRefit
from kinetree.schemas.repair import Repair
from kinetree.schemas.stiffness import FirstStiffness, SecondStiffness, Stiffness, ThirdStiffness
from kinetree.schemas.template import Template
from kinetree.tasks.numerics.stiffness import learned
from kinetree.tasks.pose import graph, pose

S = TypeVar("S", bound=Stiffness)


@task()
def first_stiffness(template: Template, repair: tuple[Repair, ...]) -> FirstStiffness:
    """Learns from the tracked poses which ties bend (ours)."""
    return _learned(FirstStiffness, template, repair)


@task()
def second_stiffness(template: Template, refit: tuple[FirstRefit, ...]) -> SecondStiffness:
    """Learns again from the first refit (ours)."""
    return _learned(SecondStiffness, template, refit)


@task()
def third_stiffness(template: Template, refit: tuple[SecondRefit, ...]) -> ThirdStiffness:
    """Learns again from the second refit (ours)."""
    return _learned(ThirdStiffness, template, refit)


def _learned(cls: type[S], template: Template, poses: Iterable[Pose]) -> S:
    if not len(template.nodes):
        return cls(stiffness=np.empty(0))
    return cls(stiffness=learned(graph(template), [pose(p) for p in poses]))
