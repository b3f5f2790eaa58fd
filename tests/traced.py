"""What a skeleton was found from, made up so that it fits."""

import numpy as np

from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.structure.traces import Traces

RINGS = 6


def traces_of(skeleton: Skeleton) -> Traces:
    """Cones of four annuli around the ends of bones; a part for every joint that is none, and one that was dropped."""
    V, rest, parents = skeleton.vertices, skeleton.rest, np.array(skeleton.parents)
    leaves = [j for j, kind in enumerate(skeleton.kinds) if kind == "leaf"]
    carriers = [j for j, kind in enumerate(skeleton.kinds) if kind != "leaf"]
    away = np.linalg.norm(V - rest[leaves][:, None], axis=2)
    ring = (away / (0.05 * np.ptp(V))).astype(np.int32)
    within = np.arange(RINGS) < 4
    count = len(carriers)
    below = [k for k, j in enumerate(carriers) if parents[j] >= 0]
    pair = np.array([*([carriers.index(parents[carriers[k]]), k] for k in below), [0, count]], np.int32)
    at = np.array([*(carriers[k] for k in below), 0])
    bone = skeleton.lengths
    return Traces(
        threshold=0.002,
        tips=away.argmin(axis=1),
        ring=np.where(ring < 4, ring, -1),
        run=np.tile(np.where(within, np.arange(RINGS) // 2, -1), (len(leaves), 1)),
        merge=np.tile(np.where(np.arange(RINGS) < 3, 0.001 * np.arange(1, RINGS + 1), np.nan), (len(leaves), 1)),
        joint_of_annulus=np.where(within, parents[leaves][:, None], -1),
        pair=pair,
        rest=rest[at],
        drift=np.full(len(pair), 0.01),
        degrees=np.full(len(pair), 20.0),
        kept=np.ones(len(pair), bool),
        middle=np.concatenate([rest[carriers], V.mean(axis=0)[None]]),
        joint=[*carriers, -1],
        length=bone,
        deviation=0.01 * bone,
    )
