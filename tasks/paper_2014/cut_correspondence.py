"""How the meshes of successive intervals lie on each other at the cuts."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.paper_2014.cut_correspondence import mutual_pairs, nearest_agreeing

Ints = NDArray[np.int64]


@task()
def cut_correspondence(
    middle: tuple[IntervalReference, ...], alignment: tuple[Arap, ...], tips: Mapping[int, Extrema], leaves: Leaves
) -> CutCorrespondence:
    """Relates vertices and leaves of each interval to those of the next by nearness at the cut (2014, Eqs. 3, 7 and 8)."""
    end = np.cumsum([len(m.frames) for m in middle])
    first = np.cumsum([0, *(len(m.vertices) for m in middle)])
    onto = {name: np.full(first[-1], -1) for name in ("onward", "backward")}
    away = {name: np.full(first[-1], np.nan) for name in ("onward", "backward")}
    pairs = []
    for i, (a, b) in enumerate(pairwise(middle)):
        last, begin = _sides(a, alignment[end[i] - 1]), _sides(b, alignment[end[i]])
        for name, at, ask, answer in (("onward", i, last, begin), ("backward", i + 1, begin, last)):
            rows = slice(first[at], first[at + 1])
            onto[name][rows], away[name][rows] = nearest_agreeing(*ask, *answer)
        (m, P, M), (n, Q, N) = _ends(a, a.frames[-1], tips, leaves), _ends(b, b.frames[0], tips, leaves)
        pairs += [(i, m[k], n[h], np.linalg.norm(P[k] - Q[h])) for k, h in mutual_pairs(P, M, Q, N)]
    found = np.array(pairs).reshape(-1, 4)
    cut, before, behind = found[:, :3].astype(np.int64).T
    return CutCorrespondence(
        first=first[:-1], leaves=np.array([len(m.leaf) for m in middle]), onward=onto["onward"], onward_distance=away["onward"],
        backward=onto["backward"], backward_distance=away["backward"], cut=cut, before=before, behind=behind, moved=found[:, 3],
        handles=tuple(m.handles for m in middle),
    )  # fmt: skip


def _sides(middle: IntervalReference, alignment: Arap) -> tuple[Floats, Floats]:
    """An interval's reference in one of its frames, and its normals there."""
    return alignment.vertices, smoothed_normals(np.array(alignment.vertices), middle.faces, rounds=0)


def _ends(middle: IntervalReference, frame: int, tips: Mapping[int, Extrema], leaves: Leaves) -> tuple[Ints, Floats, Floats]:
    """Which of an interval's leaves a frame sees, where they are there, and their normals."""
    row = leaves.rows[middle.leaf, leaves.frames.index(frame)]
    seen = np.flatnonzero(row >= 0)
    return seen, tips[frame].stems[row[seen], -1], tips[frame].normals[row[seen]]
