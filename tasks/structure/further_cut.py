"""The body cut into rigid parts once more, in another of its poses."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import PruningParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.structure import rigid_parts as numerics
from kinetree.tasks.numerics.structure.cut_joints import cut_joints
from kinetree.tasks.numerics.structure.end_effectors import leaf_vertices
from kinetree.tasks.numerics.structure.given_correspondence import is_given, limited_confidence
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut
from kinetree.tasks.structure.kinematic_tree import tree_settings
from kinetree.tasks.structure.rigid_parts import parts_settings


@task(over="cut", among=Sequence, block="kinematic_tree")
def further_cut(
    cut_poses: CutPoses,
    reference: Reference,
    alignment: Mapping[int, Alignment],
    leaves: Leaves,
    params: PruningParams,
    index: Index,
) -> FurtherCut:
    """Divides the surface as it lies in another frame, by the settings of `rigid_parts`, and joins its parts (ours)."""
    (frame,) = index
    aligned, at = list(alignment.values()), leaves.frames.index(reference.frame)
    V, F = reference.vertices, np.asarray(reference.faces, dtype=np.int64)
    x, trust = np.stack([a.vertices for a in aligned]), np.stack([a.confidence for a in aligned])
    confidence, takes = limited_confidence(trust), take_spans(tuple(alignment))
    ends = leaf_vertices(V, leaves.positions[:, at], leaves.rows[:, at], leaves.kept)
    pose = np.array(alignment[frame].vertices, np.float64)
    parts = numerics.rigid_parts(pose, F, x, confidence, ends, settings=parts_settings(cut_poses.settings), takes=takes)
    joined = not is_given(trust, np.stack([a.residual for a in aligned]))
    joints = np.zeros((len(aligned), 0, 3))
    if joined:
        body = MovingSurface(np.array(V, np.float64), F, np.asarray(x, np.float64), surface_areas(V, reference.faces), takes)
        cut = Cut(pose, np.asarray(parts.label, np.int64), np.array(parts.R), np.array(parts.t), np.array(parts.residual))
        joints = cut_joints(body, cut, ends, confidence, tree_settings(params)._replace(hidden_bones=False))
    return FurtherCut(
        frame=frame,
        label=parts.label,
        rotation=parts.R,
        translation=parts.t,
        residual=parts.residual,
        joined=joined,
        joints=joints,
    )
