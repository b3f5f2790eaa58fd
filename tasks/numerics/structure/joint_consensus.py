"""Joints as several cuts of the same body place them: their mean, and how far apart they are (ours)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Floats, Ints

GATE = 0.035
"""Mean distance over the frames, share of the root of the area, within which joints of two cuts are the same one. Chosen on
generated bodies; between 0.025 and 0.05 the mean error changes by 0.07 % of the height at most."""


class JointMotion(NamedTuple):
    """The two parts that meet at each joint, as they move.

    R, t   : (side, frame, joint, 3, 3) · (side, frame, joint, xyz) from the reference to each frame; two sides
    weight : (frame, joint) of each frame
    """

    R: Floats
    t: Floats
    weight: Floats

    @classmethod
    def of(cls, R: Floats, t: Floats, parents: Ints, seen: Floats | None) -> "JointMotion":
        """At every joint but the root.

        R, t    : (frame, part, 3, 3) · (frame, part, xyz) from the reference
        parents : (part,) −1 for the root, which is the first
        seen    : (frame, part) share of its surface that is certain, 0 to 1; None where all of it is
        """
        own, above = np.arange(1, len(parents)), parents[1:]
        weight = np.ones((len(R), len(own))) if seen is None else np.minimum(seen[:, own], seen[:, above])
        return cls(np.stack([R[:, own], R[:, above]]), np.stack([t[:, own], t[:, above]]), weight + 1e-3)

    def carried(self, rest: Floats) -> Floats:
        """(frame, joint, xyz) where the two parts carry the joints in the mean; rest (joint, xyz) in the reference."""
        return np.asarray((np.einsum("stjxy,jy->stjx", self.R, rest) + self.t).mean(axis=0))

    def brought_back(self, joint: int, X: Floats) -> Floats:
        """(xyz,) place in the reference that the two parts carry nearest to a trajectory; X (frame, xyz) mesh unit."""
        local = np.einsum("styx,sty->tx", self.R[:, :, joint], X - self.t[:, :, joint]) / len(self.R)
        w = self.weight[:, joint]
        return np.asarray(w @ local / w.sum())


class JointConsensus(NamedTuple):
    """Joints that several cuts agree on.

    rest     : (joint, xyz) mean of the cuts that have the joint, in the reference, mesh unit
    spread   : (joint,) root mean square distance of these cuts' joints from it, mesh unit; NaN where one cut alone has it
    agreeing : (joint,) cuts that have it, the first among them
    """

    rest: Floats
    spread: Floats
    agreeing: Ints


def joint_consensus(rest: Floats, motion: JointMotion, others: Sequence[Floats], size: float) -> JointConsensus:
    """Gathers for each joint of one cut the joints of other cuts that move as it does, and averages them.

    Which joints there are, and how they hang together, is that cut's alone: the first one's, or see `agreeing_cut`.

    rest   : (joint, xyz) of the cut whose tree is used, in the reference, mesh unit
    motion : of the parts at these joints
    others : by cut, (frame, joint, xyz) its joints in every frame, mesh unit
    size   : root of the area, mesh unit
    """
    own = motion.carried(rest)
    places = [[place] for place in rest]
    for X in others:
        for j, k in same_joints(own, X, GATE * size):
            places[j].append(motion.brought_back(j, X[:, k]))
    mean = np.array([np.mean(found, axis=0) for found in places]).reshape(-1, 3)
    apart = [np.sqrt(((np.array(found) - m) ** 2).sum(axis=1).mean()) for found, m in zip(places, mean, strict=True)]
    agreeing = np.array([len(found) for found in places], np.int64)
    return JointConsensus(mean, np.where(agreeing > 1, apart, np.nan), agreeing)


def same_joints(X: Floats, Y: Floats, gate: float) -> list[tuple[int, int]]:
    """Pairs of joints of two cuts whose mean distance over the frames is below a gate; the least sum of min(distance, gate).

    X, Y : (frame, joint, xyz) · (frame, other, xyz) mesh unit
    gate : mesh unit
    """
    apart = np.linalg.norm(X[:, :, None] - Y[:, None], axis=3).mean(axis=0)
    rows, columns = linear_sum_assignment(np.minimum(apart, gate))
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if apart[i, j] < gate]
