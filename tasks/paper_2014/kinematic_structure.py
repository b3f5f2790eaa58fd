"""The articulated body of the 2014 paper, as the skeleton that every method ends with."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.paper_2014.arap import Arap, by_interval
from kinetree.schemas.paper_2014.bones import Bones
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.paper_2014.kinematic_structure import KinematicStructureParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.input.sequence import refuse_further
from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.paper_2014 import kinematic_structure as numerics
from kinetree.tasks.numerics.paper_2014.bones import adjacent, joint_adjacency
from kinetree.tasks.numerics.paper_2014.joint_tree import JointTree, joint_tree
from kinetree.tasks.numerics.paper_2014.transfer import composed_map, mapped_positions


@task()
def kinematic_structure(
    interval_references: tuple[IntervalReference, ...],
    alignments: tuple[Arap, ...],
    cone_consistency: ConeConsistency,
    cut_correspondence: CutCorrespondence,
    cylinders: Cylinders,
    bones: Bones,
    sequence: Sequence,
    params: KinematicStructureParams,
) -> Skeleton:
    """Joins joints and rigid parts in one tree, adds bones to the leaves and gives all bones fixed lengths (2014, Sec. 6.3)."""
    refuse_further(sequence, "the method of 2014")
    reference = interval_references[cylinders.interval]
    label, part = cylinders.label.astype(np.int64), bones.part.astype(np.int64)
    model = numerics.Model(reference.vertices, reference.area, label, part)
    moving = [np.stack([a.vertices for a in group]) for group in by_interval(alignments, interval_references)]
    x = _model_positions(cylinders.interval, len(reference.vertices), moving, cut_correspondence)
    leaf_vertex, leaf_position = _leaves(cylinders.interval, interval_references, moving, cone_consistency, x)
    tree = _joint_tree(model, reference.faces.astype(np.int64), bones)
    body = numerics.kinematic_structure(model, x, tree, bones.centroid, leaf_vertex, leaf_position, params.surface)
    return Skeleton(
        frames=bones.frames,
        fps=sequence.fps,
        unit=sequence.unit,
        vertices=reference.vertices,
        faces=reference.faces,
        **{**body._asdict(), "parents": tuple(body.parents.tolist())},
    )


def _joint_tree(model: numerics.Model, F: Ints, bones: Bones) -> JointTree:
    """The tree of joints and rigid parts along the bones that are not redundant."""
    count = len(model.part)
    area = np.bincount(model.label, model.area, count).astype(np.float64)
    of_part = joint_adjacency(adjacent(model.label, F, count), model.part) & (model.part < 0)
    rigid = model.part >= 0
    part_area = np.bincount(model.part[rigid], area[rigid], len(of_part)).astype(np.float64)
    bone, bone_part = bones.bone[bones.in_tree].astype(np.int64), bones.bone_part[bones.in_tree].astype(np.int64)
    return joint_tree(bone, bone_part, of_part, area, part_area)


def _model_positions(model: int, vertices: int, moving: list[Floats], cut_correspondence: CutCorrespondence) -> Floats:
    """(frame, vertex, xyz) the model mesh in all frames of the sequence, NaN where no map over the cuts leads there."""
    maps = cut_correspondence.maps()
    images = [composed_map(*maps, model, i, vertices) for i in range(len(moving))]
    return np.concatenate([mapped_positions(x, image) for x, image in zip(moving, images, strict=True)])


def _leaves(
    model: int, references: tuple[IntervalReference, ...], moving: list[Floats], cone_consistency: ConeConsistency, x: Floats
) -> tuple[Ints, Floats]:
    """(leaf,) the model mesh's vertex at each leaf that its interval sees, and (frame, leaf, xyz) where that leaf is.

    In an interval that does not see a leaf, the position of the model mesh's vertex is taken.
    """
    leaf = cone_consistency.leaf
    cones = [c for c, n in enumerate(leaf[model]) if n >= 0 and references[model].leaf_vertex[n] >= 0]
    vertex = references[model].leaf_vertex[leaf[model][cones]].astype(np.int64)
    position = x[:, vertex].copy()
    begin = 0
    for i, own in enumerate(moving):
        for e, cone in enumerate(cones):
            own_vertex = references[i].leaf_vertex[leaf[i, cone]] if leaf[i, cone] >= 0 else -1
            if own_vertex >= 0:
                position[begin : begin + len(own), e] = own[:, own_vertex]
        begin += len(own)
    return vertex, position
