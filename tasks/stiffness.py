"""How stiff every tie of the deformation graph is, learned from all frames, three times."""

from collections.abc import Iterable
from typing import TypeVar

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.pieces import Pieces
from kinetree.schemas.pose import Pose
from kinetree.schemas.refit import SecondRefit
from kinetree.schemas.repair import Repair
from kinetree.schemas.stiffness import FirstStiffness, SecondStiffness, Stiffness, ThirdStiffness
from kinetree.schemas.template import Template
from kinetree.schemas.twist import Twist
from kinetree.schemas.untwisting import Untwisting
from kinetree.tasks.numerics.stiffness import freed, learned, loosened
from kinetree.tasks.pose import graph, pose

S = TypeVar("S", bound=Stiffness)


@task()
def first_stiffness(template: Template, repair: tuple[Repair, ...]) -> FirstStiffness:
    """Learns from the tracked poses which ties bend (ours)."""
    return _learned(FirstStiffness, template, repair)


@task()
def second_stiffness(template: Template, refit: tuple[Untwisting, ...], twist: Twist) -> SecondStiffness:
    """Learns again from the first refit, in which limbs got their twist back (ours)."""
    return _learned(SecondStiffness, template, refit, twist)


@task()
def third_stiffness(
    template: Template, refit: tuple[SecondRefit, ...], twist: Twist, pieces: Pieces
) -> ThirdStiffness:
    """Learns again from the second refit, and lets pieces turn against each other more freely (ours)."""
    found = _learned(ThirdStiffness, template, refit, twist)
    if not len(template.nodes):
        return found
    return ThirdStiffness(stiffness=loosened(graph(template), found.stiffness, pieces.label.astype(np.int64)))


def _learned(cls: type[S], template: Template, poses: Iterable[Pose], twist: Twist | None = None) -> S:
    if not len(template.nodes):
        return cls(stiffness=np.empty(0))
    body = graph(template)
    found = learned(body, [pose(p) for p in poses])
    return cls(stiffness=found if twist is None else freed(body, found, twist.limb.astype(np.int64)))
