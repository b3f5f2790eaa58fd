"""How rigging papers compare two skeletons (RigNet: Xu, Zhou, Kalogerakis, Landreth, Singh 2020, Sec. 6.1, and successors).

All distances are symmetric Chamfer distances: the mean of the two one-way means. Published tables give them in hundredths of
the cube into which the mesh fits; `side` is that cube's.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

Floats = npt.NDArray[np.float64]
STEP = 0.005
"""Spacing of the points that stand for a bone, share of the cube's side, as in the published code."""


class Chamfer(NamedTuple):
    """Distances between two skeletons in hundredths of the cube: joints–joints, joints–bones, bones–bones."""

    j2j: float
    j2b: float
    b2b: float


class Overlap(NamedTuple):
    """Joints that agree: 2·n / (found + true), n / found and n / true, where n pairs are nearer than their tolerance."""

    iou: float
    precision: float
    recall: float


def chamfer(X: Floats, above: Sequence[int], Y: Floats, true_above: Sequence[int], side: float) -> Chamfer:
    """CD-J2J, CD-J2B, CD-B2B, averaged over the frames.

    X, above      : (frame, joint, xyz) found, mesh unit; (joint,) parent of each, −1 for a root
    Y, true_above : (frame, true, xyz) true; (true,) parents
    side          : of the cube into which the mesh fits, mesh unit
    """
    found = np.array([_one_frame(x, above, y, true_above, STEP * side) for x, y in zip(X, Y, strict=True)])
    j2j, j2b, b2b = (found.mean(axis=0) / side * 100.0).tolist()
    return Chamfer(j2j, j2b, b2b)


def overlap(X: Floats, Y: Floats, tolerance: Floats) -> Overlap:
    """Joint IoU, precision and recall, averaged over the frames: Hungarian matching, a pair counts below its tolerance.

    X, Y      : (frame, joint, xyz) found and (frame, true, xyz) true, mesh unit
    tolerance : (true,) half the local diameter of the body at each true joint, mesh unit
    """
    count = 0.0
    for x, y in zip(X, Y, strict=True):
        apart = np.linalg.norm(x[:, None] - y[None], axis=2)
        rows, columns = linear_sum_assignment(apart)
        count += float((apart[rows, columns] < tolerance[columns]).sum())
    count /= max(len(X), 1)
    n, m = X.shape[1], Y.shape[1]
    return Overlap(2.0 * count / (n + m), count / n, count / m)


def _one_frame(x: Floats, above: Sequence[int], y: Floats, true_above: Sequence[int], step: float) -> tuple[float, ...]:
    bones, true_bones = _bones(x, above), _bones(y, true_above)
    apart = np.linalg.norm(x[:, None] - y[None], axis=2)
    j2j = apart.min(axis=1).mean() + apart.min(axis=0).mean()
    j2b = _to_bones(x, true_bones).mean() + _to_bones(y, bones).mean()
    b2b = _to_bones(_points(bones, step), true_bones).mean() + _to_bones(_points(true_bones, step), bones).mean()
    return float(j2j) / 2.0, float(j2b) / 2.0, float(b2b) / 2.0


def _bones(x: Floats, above: Sequence[int]) -> Floats:
    """(bone, 2, xyz) both ends of every bone; a skeleton of one joint has one bone without length."""
    ends = [(p, j) for j, p in enumerate(above) if p >= 0] or [(0, 0)]
    return x[np.array(ends)]


def _points(bones: Floats, step: float) -> Floats:
    """(point, xyz) points about `step` apart along every bone, its ends among them."""
    out = []
    for a, b in bones:
        count = max(round(float(np.linalg.norm(b - a)) / step), 1)
        out.append(a + np.linspace(0.0, 1.0, count + 1)[:, None] * (b - a))
    return np.concatenate(out)


def _to_bones(P: Floats, bones: Floats) -> Floats:
    """(point,) distance from each point to the nearest point of any bone."""
    a, d = bones[:, 0], bones[:, 1] - bones[:, 0]
    square = np.maximum((d * d).sum(axis=1), 1e-300)
    along = np.clip(((P[:, None] - a) * d).sum(axis=2) / square, 0.0, 1.0)
    apart: Floats = np.linalg.norm(P[:, None] - (a + along[:, :, None] * d), axis=2).min(axis=1)
    return apart
