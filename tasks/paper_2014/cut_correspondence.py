"""Correspondences between the meshes of successive intervals at the cuts between them."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.paper_2014.arap import Arap, by_interval
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.paper_2014.cut_correspondence import mutual_pairs, nearest_agreeing


@task()
def cut_correspondence(
    interval_references: tuple[IntervalReference, ...], alignments: tuple[Arap, ...], extrema: Mapping[int, Extrema]
) -> CutCorrespondence:
    """Relates vertices and leaves of each interval to those of the next by nearness at the cut (2014, Eqs. 3, 7 and 8)."""
    groups = by_interval(alignments, interval_references)
    first = np.cumsum([0, *(len(r.vertices) for r in interval_references)])
    to_next, to_previous = np.full(first[-1], -1), np.full(first[-1], -1)
    next_distance, previous_distance = np.full(first[-1], np.nan), np.full(first[-1], np.nan)
    pairs = []
    for i, (before, after) in enumerate(pairwise(interval_references)):
        own, other = slice(first[i], first[i + 1]), slice(first[i + 1], first[i + 2])
        end, begin = _surface(before, groups[i][-1]), _surface(after, groups[i + 1][0])
        to_next[own], next_distance[own] = nearest_agreeing(*end, *begin)
        to_previous[other], previous_distance[other] = nearest_agreeing(*begin, *end)
        (m, P, M), (n, Q, N) = _leaves(before, -1, extrema), _leaves(after, 0, extrema)
        pairs += [(i, m[k], n[h], np.linalg.norm(P[k] - Q[h])) for k, h in mutual_pairs(P, M, Q, N)]
    table = np.array(pairs).reshape(-1, 4)
    cut, leaf_before, leaf_after = table[:, :3].astype(np.int64).T
    return CutCorrespondence(
        first=first[:-1], leaf_count=np.array([len(r.leaf) for r in interval_references]),
        to_next=to_next, to_next_distance=next_distance, to_previous=to_previous, to_previous_distance=previous_distance,
        cut=cut, leaf_before=leaf_before, leaf_after=leaf_after, leaf_distance=table[:, 3],
        genus=tuple(r.genus for r in interval_references),
    )  # fmt: skip


def _surface(reference: IntervalReference, alignment: Arap) -> tuple[Floats, Floats]:
    """An interval's reference in one of its frames, and its normals there."""
    return alignment.vertices, smoothed_normals(np.array(alignment.vertices), reference.faces, rounds=0)


def _leaves(
    reference: IntervalReference, position: int, extrema: Mapping[int, Extrema]
) -> tuple[NDArray[np.integer], Floats, Floats]:
    """The leaves that are seen in the frame at a position of an interval, where they are there, and their normals."""
    row, here = reference.extremum[:, position], extrema[reference.frames[position]]
    visible = np.flatnonzero(row >= 0)
    return visible, here.stems[row[visible], -1], here.normals[row[visible]]
