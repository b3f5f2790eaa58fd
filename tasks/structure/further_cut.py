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
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.structure import rigid_parts as numerics
from kinetree.tasks.numerics.structure.end_effectors import leaf_vertices
from kinetree.tasks.numerics.structure.given_correspondence import limited_confidence
from kinetree.tasks.structure.rigid_parts import parts_settings


@task(over="cut", among=Sequence)
def further_cut(
    cut_poses: CutPoses, reference: Reference, alignment: Mapping[int, Alignment], leaves: Leaves, index: Index
) -> FurtherCut:
    """Divides the surface as it lies in another frame, by the settings of `rigid_parts` (ours)."""
    (frame,) = index
    aligned, at = list(alignment.values()), leaves.frames.index(reference.frame)
    parts = numerics.rigid_parts(
        np.array(alignment[frame].vertices, np.float64),
        np.asarray(reference.faces, dtype=np.int64),
        np.stack([a.vertices for a in aligned]),
        limited_confidence(np.stack([a.confidence for a in aligned])),
        leaf_vertices(reference.vertices, leaves.positions[:, at], leaves.rows[:, at], leaves.kept),
        settings=parts_settings(cut_poses.settings),
        takes=take_spans(tuple(alignment)),
    )
    return FurtherCut(frame=frame, label=parts.label, rotation=parts.R, translation=parts.t, residual=parts.residual)
