"""Graphs that find a generated body's true skeleton, or that skeleton without a limb, so that two runs can be compared."""

from collections.abc import Mapping

import numpy as np
from results import true_skeleton_graph
from results.sample_report import UP, followed, halves
from results.true_skeletons import generated, perfect

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.evaluation.body import blended_skin

LIMB = ("shoulder_r", "hand_r")
"""What a human of a few frames has of an arm: its elbow and wrist turn too little to be scored."""


@task(over="frame")
def alignment(skeleton: Skeleton, source: Source, mesh: Mesh, index: Index) -> Alignment:
    """The skin, as it should be."""
    t = skeleton.frames.index(index[0])
    s = skeleton
    V = blended_skin(s.vertices, s.influence, s.weight, s.rest, s.rotation[t], s.positions[t])
    one = np.ones(len(V))
    return Alignment(vertices=V, residual=0 * one, stretch=one, confidence=one, uncovered=0.0)


@task()
def intervals(skeleton: Skeleton) -> Intervals:
    """Two halves."""
    return halves(skeleton.frames)


@task()
def leaves(skeleton: Skeleton) -> Leaves:
    """The ends of bones."""
    return followed(skeleton)


@task()
def up_direction(skeleton: Skeleton) -> UpDirection:
    """Along y."""
    return UP


def without(skeleton: Skeleton, *names: str) -> Skeleton:
    """The skeleton without some joints, which have none below them but each other; what they carried follows the root."""
    stay = [j for j, name in enumerate(skeleton.names) if name not in names]
    number = np.zeros(len(skeleton.names), np.int32)
    number[stay] = np.arange(len(stay))
    per_joint = {name: getattr(skeleton, name)[stay] for name in ("rest", "degrees", "drift", "support")}
    per_frame = {name: getattr(skeleton, name)[:, stay] for name in ("positions", "rotation", "confidence")}
    rest = {name: getattr(skeleton, name) for name in ("frames", "fps", "unit", "vertices", "faces", "weight")}
    return Skeleton(
        **rest, **per_joint, **per_frame,
        names=tuple(skeleton.names[j] for j in stay), kinds=tuple(skeleton.kinds[j] for j in stay),
        parents=tuple(int(number[p]) if (p := skeleton.parents[j]) >= 0 else -1 for j in stay),
        label=number[np.maximum(skeleton.label, 0)], influence=number[skeleton.influence],
    )  # fmt: skip


@task()
def skeleton(source: Mapping[int, Source]) -> Skeleton:
    """The truth without an arm."""
    return without(perfect(next(iter(source.values())).recipe or generated()), *LIMB)


SHOWN = (alignment, intervals, leaves, up_direction)
WHOLE = Graph.of((*true_skeleton_graph.GRAPH.tasks, *SHOWN))
ONE_ARMED = Graph.of((*(t for t in true_skeleton_graph.GRAPH.tasks if t.name != "skeleton"), skeleton, *SHOWN))
