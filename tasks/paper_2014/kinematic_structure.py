"""The articulated body of the 2014 paper, in the form in which every method leaves it."""

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.bones import Bones
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.paper_2014.kinematic_structure import KinematicStructureParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.paper_2014 import kinematic_structure as structure
from kinetree.tasks.numerics.paper_2014.across_cuts import carried, way
from kinetree.tasks.numerics.paper_2014.assembly import Hung, hung
from kinetree.tasks.numerics.paper_2014.bones import adjacent
from kinetree.tasks.paper_2014.cone_consistency import cuts_of
from kinetree.tasks.paper_2014.cylinders import motions


@task()
def kinematic_structure(
    middle: tuple[IntervalReference, ...],
    alignment: tuple[Arap, ...],
    consistency: ConeConsistency,
    crossing: CutCorrespondence,
    cylinders: Cylinders,
    bones: Bones,
    sequence: Sequence,
    params: KinematicStructureParams,
) -> Skeleton:
    """Hangs joints and bodies in one tree, adds bones to the leaves and gives all bones fixed lengths (2014, Sec. 6.3)."""
    home = middle[cylinders.interval]
    moving = motions(middle, alignment)
    y = _carried(cylinders.interval, middle, moving, crossing)
    tip, tips = _tips(cylinders.interval, middle, moving, consistency, y)
    found = structure.kinematic_structure(
        home.vertices,
        home.area,
        y,
        cylinders.label.astype(np.int64),
        bones.body.astype(np.int64),
        _tree(home, cylinders, bones),
        bones.centroid,
        tip,
        tips,
        params.surface,
    )
    return Skeleton(
        frames=bones.frames,
        fps=sequence.fps,
        unit=sequence.unit,
        vertices=home.vertices,
        faces=home.faces,
        **{**found._asdict(), "parents": tuple(found.parents.tolist())},
    )


def _tree(home: IntervalReference, cylinders: Cylinders, bones: Bones) -> Hung:
    """The bones that are not redundant, hung from the largest body."""
    count = len(bones.body)
    area = np.bincount(cylinders.label, home.area, count).astype(np.float64)
    body = bones.body.astype(np.int64)
    meets = adjacent(cylinders.label.astype(np.int64), home.faces.astype(np.int64), count)
    touches = np.array([meets[:, body == b].any(axis=1) & (body < 0) for b in range(int(body.max()) + 1)])
    size = np.bincount(body[body >= 0], area[body >= 0], len(touches)).astype(np.float64)
    bone, carrier = bones.bone[bones.kept].astype(np.int64), bones.carrier[bones.kept].astype(np.int64)
    return hung(bone, carrier, touches.reshape(-1, count), area, size)


def _carried(home: int, middle: tuple[IntervalReference, ...], moving: list[Floats], crossing: CutCorrespondence) -> Floats:
    """(frame, vertex, xyz) the home interval's reference in all frames of the sequence, NaN where the way is broken."""
    cuts = cuts_of(crossing)
    onward, backward = [c.onward for c in cuts], [c.backward for c in cuts]
    out = []
    for i, x in enumerate(moving):
        to = way(onward, backward, home, i, len(middle[home].vertices))
        out.append(carried(x, to))
    return np.concatenate(out)


def _tips(
    home: int, middle: tuple[IntervalReference, ...], moving: list[Floats], consistency: ConeConsistency, y: Floats
) -> tuple[NDArray[np.int64], Floats]:
    """The home reference's vertex at each leaf that it has, and where that leaf is in every frame.

    Where an interval does not see a leaf, the vertex carried there stands for it.
    """
    leaf = consistency.leaf
    seen = [c for c, n in enumerate(leaf[home]) if n >= 0 and middle[home].tip[n] >= 0]
    tip = middle[home].tip[leaf[home][seen]].astype(np.int64)
    tips = y[:, tip].copy()
    begin = 0
    for i, x in enumerate(moving):
        for e, cone in enumerate(seen):
            own = middle[i].tip[leaf[i, cone]] if leaf[i, cone] >= 0 else -1
            if own >= 0:
                tips[begin : begin + len(x), e] = x[:, own]
        begin += len(x)
    return tip, tips
