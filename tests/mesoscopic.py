"""A pipe of three arms that swing, through all tasks of the paper's Step III, each called as the plain function it is.

The body is known: arms of length 24 that turn at 12 from the middle, which is the root. It is seen in two intervals; in the
second the leaf of one arm is not seen. Vertices are tracked, so that alignments and correspondences are exact.
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

SPANS = (range(12), range(12, 20))
SEEN = ((0, 1, 2), (0, 2))
"""The arms whose leaves each interval sees."""


@dataclass(frozen=True)
class Mesoscopic:
    """The artifact of every task."""

    body: Known
    interval_references: tuple[IntervalReference, ...]
    alignments: tuple[Arap, ...]
    cut_correspondence: CutCorrespondence
    cones: tuple[Cones, ...]
    cone_consistency: ConeConsistency
    annuli: dict[tuple[int, int], Annuli]
    integration: Integration
    cylinders: Cylinders
    bones: Bones
    skeleton: Skeleton


def leaf_vertices(body: Known) -> np.ndarray:
    """(arm,) the outermost vertex of each."""
    angle = 2 * np.pi * np.arange(3) / 3
    return (body.V @ np.stack([np.cos(angle), np.sin(angle), 0 * angle])).argmax(axis=0)


def interval(body: Known, span: range, arms: tuple[int, ...], distance: Floats) -> IntervalReference:
    """The reference of one interval, of its middle frame."""
    frame = span[len(span) // 2]
    vertex = leaf_vertices(body)[list(arms)]
    return IntervalReference(
        frames=tuple(span), frame=frame, vertices=body.x[frame], faces=body.F, area=body.area,
        size=float(np.sqrt(body.area.sum())), leaf=np.array(arms), leaf_vertex=vertex, coordinates=distance[list(arms)],
        extremum=np.tile(np.arange(len(arms))[:, None], len(span)), tracked=True,
    )  # fmt: skip


def correspondence(body: Known, references: tuple[IntervalReference, ...]) -> CutCorrespondence:
    """Every vertex corresponds to itself; the leaves of the first and the last arm are each other's nearest."""
    count = len(body.V)
    every, none, near = np.arange(count), np.full(count, -1), np.zeros(count)
    return CutCorrespondence(
        first=np.array([0, count]), leaf_count=np.array([len(r.leaf) for r in references]),
        to_next=np.append(every, none), to_next_distance=np.append(near, near + np.nan),
        to_previous=np.append(none, every), to_previous_distance=np.append(near + np.nan, near),
        cut=np.zeros(2, int), leaf_before=np.array([0, 2]), leaf_after=np.array([0, 1]), leaf_distance=np.full(2, 0.1),
    )  # fmt: skip


def aligned(body: Known, rigid_residual: float) -> tuple[Arap, ...]:
    """Exact alignments in all frames."""
    plain = np.ones(len(body.V))
    return tuple(
        Arap(vertices=x, residual=0 * plain, stretch=plain, confidence=plain, uncovered=0.0, rigid_residual=rigid_residual)
        for x in body.x[: SPANS[-1].stop]
    )


@cache
def mesoscopic(*, at_rest: bool = False) -> Mesoscopic:
    """All artifacts; arms at rest show no joint."""
    rotation = np.broadcast_to(np.eye(3), (24, 4, 3, 3)).copy() if at_rest else swings(24, 4, degrees=40.0)
    body = three_arms(rotation)
    distance = geodesic_distance(Surface.of(body.V, body.F), leaf_vertices(body))
    references = tuple(interval(body, span, arms, distance) for span, arms in zip(SPANS, SEEN, strict=True))
    alignments, cuts = aligned(body, 1.0 if at_rest else 9.0), correspondence(body, references)
    mu = Geodesics(mu=distance.sum(axis=0), area=body.area, bases=np.zeros(0, int), share=1.0)
    of_interval = tuple(cones(r, dict.fromkeys(r.frames, mu), ConesParams()) for r in references)
    consistent = cone_consistency(references, of_interval, cuts, ConeConsistencyParams())
    clusters = {
        (i, c): annuli((i, c), consistent, r, {t: alignments[t] for t in r.frames}, AnnuliParams())
        for i, r in enumerate(references)
        for c in consistent.members("interval/cone", (i,))
    }
    integrated = integration(consistent, tuple(clusters.values()))
    areas = cylinders(references, alignments, consistent, cuts, integrated)
    links = bones(references, alignments, consistent, cuts, areas)
    sequence = Sequence(frames=links.frames, fps=25.0, unit="mm")
    given = (references, alignments, consistent, cuts, areas, links, sequence, KinematicStructureParams())
    skeleton = kinematic_structure(*given)
    return Mesoscopic(body, references, alignments, cuts, of_interval, consistent, clusters, integrated, areas, links, skeleton)
