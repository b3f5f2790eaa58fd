"""A skeleton over time, and directions of its body: along the trunk, across a pair of limbs (ours)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.limbs import Limb

APART = 0.05
"""Distance of two innermost joints from which on they say where left is, share of the length of both limbs."""


class Motion(NamedTuple):
    """A skeleton over time.

    rest     : (joint, xyz) in the reference pose, mesh unit
    parents  : (joint,) −1 for the root, parents first
    X        : (frame, joint, xyz) mesh unit
    R        : (frame, joint, row, xyz) from the reference pose to each frame
    up       : (xyz,) unit vector
    """

    rest: Floats
    parents: Ints
    X: Floats
    R: Floats
    up: Floats


def along_trunk(body: Motion, legs: tuple[Limb, ...], arms: tuple[Limb, ...]) -> Floats:
    """(frame, xyz) unit vectors from where the legs hang to where the arms hang."""
    along = middle(body, arms) - middle(body, legs)
    return np.asarray(along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12))


def middle(body: Motion, pair: tuple[Limb, ...]) -> Floats:
    """(frame, xyz) middle of the innermost joints of a pair."""
    return np.asarray(np.mean([body.X[:, limb.joints[-1]] for limb in pair], axis=0))


def in_rest(body: Motion, joint: int, vectors: Floats) -> Floats:
    """(xyz,) mean over the frames of vectors (frame, xyz) turned back to the reference pose with the part of a joint."""
    return np.asarray(np.mean(np.einsum("tyx,ty->tx", body.R[:, joint], vectors), axis=0))


def across_pair(body: Motion, a: Limb, b: Limb) -> Floats:
    """(frame, xyz) from the second limb of a pair to the first, between their innermost joints.

    Where those lie in one place, the next ones count too.
    """
    apart = [body.X[:, a.joints[k]] - body.X[:, b.joints[k]] for k in range(-min(2, len(a.joints), len(b.joints)), 0)]
    is_wide = float(np.linalg.norm(apart[-1], axis=1).mean()) > APART * (a.length + b.length)
    return np.asarray(apart[-1] if is_wide else np.mean(apart, axis=0))


def horizontal(v: Floats, up: Floats) -> Floats:
    """The horizontal part of a vector, of length 1; the vector itself where it has none."""
    flat = v - (v @ up) * up
    length = float(np.linalg.norm(flat))
    return np.asarray(flat / length if length > 1e-9 else v)
