"""A pipe of three arms that swing, through all steps of the paper's Step III, each called as the plain function it is.

The body is known: arms of length 24 that turn at 12 from the middle, which is the root. It is seen in two intervals; in the
second the leaf of one arm is not. Vertices are tracked, so that nothing is lost on the way there.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from articulated import Known, swings, three_arms

from kinetree.schemas.array import Floats
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.paper_2014.annuli import Annuli, AnnuliParams
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.bones import Bones
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency, ConeConsistencyParams
from kinetree.schemas.paper_2014.cones import Cones, ConesParams
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.integration import Integration
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.paper_2014.kinematic_structure import KinematicStructureParams
from kinetree.schemas.paper_2014.limb import Limb
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.paper_2014.annuli import annuli
from kinetree.tasks.paper_2014.bones import bones
from kinetree.tasks.paper_2014.cone_consistency import cone_consistency
from kinetree.tasks.paper_2014.cones import cones
from kinetree.tasks.paper_2014.cylinders import cylinders
from kinetree.tasks.paper_2014.integration import integration
from kinetree.tasks.paper_2014.kinematic_structure import kinematic_structure
from kinetree.tasks.paper_2014.limb import limb

SPANS = (range(12), range(12, 20))
SEEN = ((0, 1, 2), (0, 2))
"""The arms whose leaves each interval sees."""


@dataclass(frozen=True)
class Made:
    """What every step gave."""

    body: Known
    middle: tuple[IntervalReference, ...]
    alignment: tuple[Arap, ...]
    crossing: CutCorrespondence
    cones: tuple[Cones, ...]
    consistency: ConeConsistency
    limb: dict[tuple[int, int], Limb]
    annuli: dict[tuple[int, int], Annuli]
    integration: Integration
    cylinders: Cylinders
    bones: Bones
    skeleton: Skeleton


def tips(body: Known) -> np.ndarray:
    """(arm,) the outermost vertex of each."""
    angle = 2 * np.pi * np.arange(3) / 3
    return (body.V @ np.stack([np.cos(angle), np.sin(angle), 0 * angle])).argmax(axis=0)


def interval(body: Known, span: range, arms: tuple[int, ...], distance: Floats) -> IntervalReference:
    """One interval, its reference amid it."""
    frame = span[len(span) // 2]
    tip = tips(body)[list(arms)]
    return IntervalReference(
        frames=tuple(span), frame=frame, vertices=body.x[frame], faces=body.F, area=body.area,
        size=float(np.sqrt(body.area.sum())), leaf=np.array(arms), tip=tip, distance=distance[list(arms)],
        trail=body.x[list(span)][:, tip].transpose(1, 0, 2),
    )  # fmt: skip


def passed(body: Known, middle: tuple[IntervalReference, ...]) -> CutCorrespondence:
    """Every vertex stays what it is; the leaves of the first and the last arm are each other's nearest."""
    count = len(body.V)
    every, none, near = np.arange(count), np.full(count, -1), np.zeros(count)
    return CutCorrespondence(
        first=np.array([0, count]), leaves=np.array([len(m.leaf) for m in middle]), onward=np.append(every, none),
        onward_distance=np.append(near, near + np.nan), backward=np.append(none, every),
        backward_distance=np.append(near + np.nan, near), cut=np.zeros(2, int), before=np.array([0, 2]),
        behind=np.array([0, 1]), moved=np.full(2, 0.1),
    )  # fmt: skip


def followed(body: Known, moved: float) -> tuple[Arap, ...]:
    """The vertices in all frames."""
    plain = np.ones(len(body.V))
    return tuple(
        Arap(vertices=x, residual=0 * plain, stretch=plain, trust=plain, uncovered=0.0, moved=moved)
        for x in body.x[: SPANS[-1].stop]
    )


@cache
def made(*, still: bool = False) -> Made:
    """All of it; arms that are still show no joint."""
    turn = np.broadcast_to(np.eye(3), (24, 4, 3, 3)).copy() if still else swings(24, 4, degrees=40.0)
    body = three_arms(turn)
    distance = geodesic_distance(Surface.of(body.V, body.F), tips(body))
    middle = tuple(interval(body, span, arms, distance) for span, arms in zip(SPANS, SEEN, strict=True))
    alignment, crossing = followed(body, 1.0 if still else 9.0), passed(body, middle)
    mu = Geodesics(mu=distance.sum(axis=0), area=body.area, bases=np.zeros(0, int), share=1.0)
    grown = tuple(cones(m, dict.fromkeys(m.frames, mu), ConesParams()) for m in middle)
    whole = cone_consistency(middle, grown, crossing, ConeConsistencyParams())
    limbs: dict[tuple[int, int], Limb] = {}
    clusters: dict[tuple[int, int], Annuli] = {}
    for i, m in enumerate(middle):
        before = None
        for c in whole.members("interval/cone", (i,)):
            before = limbs[i, c] = limb(whole, m, before)
            clusters[i, c] = annuli(before, m, {t: alignment[t] for t in m.frames}, AnnuliParams())
    joined = integration(whole, tuple(clusters.values()))
    parts = cylinders(middle, alignment, whole, crossing, joined)
    tree = bones(middle, alignment, whole, crossing, parts)
    sequence = Sequence(frames=tree.frames, fps=25.0, unit="mm")
    found = kinematic_structure(middle, alignment, whole, crossing, parts, tree, sequence, KinematicStructureParams())
    return Made(body, middle, alignment, crossing, grown, whole, limbs, clusters, joined, parts, tree, found)
