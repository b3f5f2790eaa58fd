"""How near the skinned mesh is to the aligned meshes."""

from collections.abc import Mapping

import numpy as np

from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results.scene import evenly_spread
from kinetree.tasks.results.formats.rig import skinned

COMPARED = 24
"""Frames in which the skin is compared with the aligned mesh, evenly spread; more take longer."""


def skin_distance(skeleton: Skeleton, alignments: Mapping[int, Alignment]) -> float:
    """Root mean square distance between the skinned mesh and the aligned meshes of some frames.

    alignments : by source frame number
    returns    : share of the diagonal of the body's bounding box
    """
    size = float(np.linalg.norm(np.ptp(skeleton.vertices, axis=0)))
    squared = [
        np.sum((skinned(skeleton, int(t)) - alignments[skeleton.frames[t]].vertices) ** 2, axis=1).mean()
        for t in evenly_spread(len(skeleton.frames), COMPARED)
    ]
    return float(np.sqrt(np.mean(squared))) / max(size, 1e-300)
