"""How rigging papers compare two skeletons (RigNet: Xu, Zhou, Kalogerakis, Landreth, Singh 2020, Sec. 6.1, and successors).

All distances are symmetric Chamfer distances: the mean of the two one-way means. Published tables give them in hundredths of
the side of the cube into which the mesh fits.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.results.evaluation.settings import EvaluationSettings


class Chamfer(NamedTuple):
    """Distances between two skeletons, hundredths of the cube's side: joints–joints, joints–bones, bones–bones."""

    j2j: float
    j2b: float
    b2b: float


class Overlap(NamedTuple):
    """Shares of joints that agree, n pairs being nearer than their tolerance: 2·n / (joints + true joints), n / joints and
    n / true joints.
    """

    iou: float
    precision: float
    recall: float


def chamfer(
    X: Floats,
    parents: Sequence[int],
    Y: Floats,
    true_parents: Sequence[int],
    side: float,
    settings: EvaluationSettings | None = None,
) -> Chamfer:
    """CD-J2J, CD-J2B and CD-B2B, averaged over the frames (RigNet 2020, Sec. 6.1).

    X            : (frame, joint, xyz) joints of the result, mesh unit
    parents      : (joint,) parent of each, −1 for a root
    Y            : (frame, true, xyz) true joints, mesh unit
    true_parents : (true,) parent of each, −1 for a root
    side         : side of the cube into which the mesh fits, mesh unit
    settings     : bone_step is used
    """
    step = (settings or EvaluationSettings()).bone_step * side
    distances = np.array([_of_frame(x, parents, y, true_parents, step) for x, y in zip(X, Y, strict=True)])
    j2j, j2b, b2b = (distances.mean(axis=0) / side * 100.0).tolist()
    return Chamfer(j2j, j2b, b2b)


def overlap(X: Floats, Y: Floats, tolerance: Floats) -> Overlap:
    """Joint IoU, precision and recall, averaged over the frames (RigNet 2020, Sec. 6.1).

    Pairs are matched in every frame by the Hungarian method; one counts where its distance is below the tolerance.

    X         : (frame, joint, xyz) joints of the result, mesh unit
    Y         : (frame, true, xyz) true joints, mesh unit
    tolerance : (true,) half the local diameter of the body at each true joint, mesh unit
    returns   : shares, 0 to 1
    """
    count = 0.0
    for x, y in zip(X, Y, strict=True):
        distance = np.linalg.norm(x[:, None] - y[None], axis=2)
        rows, columns = linear_sum_assignment(distance)
        count += float((distance[rows, columns] < tolerance[columns]).sum())
    count /= max(len(X), 1)
    n, m = X.shape[1], Y.shape[1]
    return Overlap(2.0 * count / (n + m), count / n, count / m)


def _of_frame(x: Floats, parents: Sequence[int], y: Floats, true_parents: Sequence[int], step: float) -> tuple[float, ...]:
    """The three distances in one frame, mesh unit."""
    bones, true_bones = _bones(x, parents), _bones(y, true_parents)
    distance = np.linalg.norm(x[:, None] - y[None], axis=2)
    j2j = distance.min(axis=1).mean() + distance.min(axis=0).mean()
    j2b = _to_bones(x, true_bones).mean() + _to_bones(y, bones).mean()
    b2b = _to_bones(_points(bones, step), true_bones).mean() + _to_bones(_points(true_bones, step), bones).mean()
    return float(j2j) / 2.0, float(j2b) / 2.0, float(b2b) / 2.0


def _bones(x: Floats, parents: Sequence[int]) -> Floats:
    """(bone, 2, xyz) both ends of every bone; a skeleton of one joint has one bone without length."""
    ends = [(p, j) for j, p in enumerate(parents) if p >= 0] or [(0, 0)]
    return x[np.array(ends)]


@compiled
def _points(bones: Floats, step: float) -> Floats:
    """(point, xyz) points along every bone about `step` apart, including its ends."""
    count = np.empty(len(bones), np.int64)
    for b in range(len(bones)):
        length = np.sqrt(((bones[b, 1] - bones[b, 0]) ** 2).sum())
        count[b] = max(round(length / step), 1)
    out = np.empty((count.sum() + len(bones), 3))
    row = 0
    for b in range(len(bones)):
        for k in range(count[b] + 1):
            for x in range(3):
                out[row, x] = bones[b, 0, x] + k / count[b] * (bones[b, 1, x] - bones[b, 0, x])
            row += 1
    return out


@compiled
def _to_bones(P: Floats, bones: Floats) -> Floats:
    """(point,) distance from each point to the nearest point of any bone."""
    out = np.empty(len(P))
    for i in range(len(P)):
        least = np.inf
        for b in range(len(bones)):
            square, along, off = 1e-300, 0.0, 0.0
            for x in range(3):
                d = bones[b, 1, x] - bones[b, 0, x]
                square += d * d
                along += (P[i, x] - bones[b, 0, x]) * d
            along = min(max(along / square, 0.0), 1.0)
            for x in range(3):
                off += (P[i, x] - bones[b, 0, x] - along * (bones[b, 1, x] - bones[b, 0, x])) ** 2
            least = min(least, off)
        out[i] = np.sqrt(least)
    return out
