"""Part labels of all input vertices, and the aligned meshes."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.segmentation import Segmentation
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.colours import part_colours
from kinetree.tasks.results.formats.labels import input_labels
from kinetree.tasks.results.formats.rig import skinned


@task()
def segmentation(
    skeleton: Skeleton, joint_names: JointNames, alignment: Mapping[int, Alignment], projection: Mapping[int, Projection]
) -> Segmentation:
    """Gathers the part labels of the input's vertices and the aligned meshes (2014, Sec. 6)."""
    labels = [input_labels(skeleton, projection[frame]) for frame in skeleton.frames]
    end = np.cumsum([len(label) for label in labels])
    aligned = np.stack([alignment[frame].vertices.astype(np.float32) for frame in skeleton.frames])
    distance = [
        np.linalg.norm(skinned(skeleton, t) - alignment[frame].vertices, axis=1) for t, frame in enumerate(skeleton.frames)
    ]
    return Segmentation(
        names=joint_names.names,
        unit=skeleton.unit,
        error=float(np.sqrt(np.mean(np.square(distance)))),
        error_95=float(np.quantile(distance, 0.95)),
        frame=np.array(skeleton.frames),
        begin=end - [len(label) for label in labels],
        end=end,
        label=np.concatenate(labels),
        part=skeleton.label,
        faces=skeleton.faces,
        colour=_colours(skeleton),
        aligned=aligned,
    )


def _colours(skeleton: Skeleton) -> NDArray[np.uint8]:
    """(joint, rgb) colour of the part of every joint; white where it has none."""
    known = part_colours(skeleton.label, skeleton.faces)
    rows = np.full(len(skeleton.names), len(known) - 1)
    rows[: len(known) - 1] = np.arange(len(known) - 1)
    return np.asarray(known[rows], np.uint8)
