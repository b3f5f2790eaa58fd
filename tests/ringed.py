"""Cuts of a bending tube that have rings of flesh as parts, beside the true ones."""

from typing import NamedTuple, cast

import numpy as np
from articulated import ALL_STAY, Known, chain, swings
from smeared import moving

from kinetree.tasks.numerics.structure.first_tree import FirstTree, first_tree
from kinetree.tasks.numerics.structure.tree_joints import Cut

FRAMES = 24
HEIGHTS = (-3.0, 0.0, 2.6)
"""Of the true joints."""
TIPS = np.zeros(0, np.int64)


def body() -> Known:
    return chain(HEIGHTS, swings(FRAMES, len(HEIGHTS) + 1, 25, seed=2), along=60)


def with_ring(cut: Cut, at: tuple[float, float], slide: float) -> Cut:
    """A cut with one part more, a ring between two heights that turns a little against the part above and slides by so much."""
    z, (low, high) = cut.V[:, 2], at
    above = int(cut.label[np.abs(z - high).argmin()])
    R, t = (np.concatenate([a, a[:, above : above + 1]], axis=1) for a in (cut.R, cut.t))
    middle, turn = np.array([0.0, 0.0, (low + high) / 2]), swings(FRAMES, 1, 8, seed=3)[:, 0]
    R[:, -1] = R[:, -1] @ turn
    t[:, -1] += np.einsum("txy,y->tx", R[:, above], middle) - np.einsum("txy,y->tx", R[:, -1], middle)
    t[:, -1] += slide * np.random.default_rng(0).normal(size=(FRAMES, 3))
    return Cut(cut.V, np.where((z > low) & (z < high), R.shape[1] - 1, cut.label), R, t, np.zeros(R.shape[:2]))


def cut_of(true: Known, *rings: tuple[tuple[float, float], float]) -> FirstTree:
    """The tree of a cut with the true parts, and with such rings."""
    cut = Cut(true.V, true.label, true.R, true.t, true.residual)
    for at, slide in rings:
        cut = with_ring(cut, at, slide)
    return first_tree(moving(true), cut, TIPS, settings=ALL_STAY)


def ringed(slide: float, at: tuple[float, float] = (0.0, 0.9)) -> FirstTree:
    return cut_of(body(), (at, slide))


class OtherTree(NamedTuple):
    """A tree of which no more is known than where its joints go, (frame, joint, xyz)."""

    joints: np.ndarray
    label: np.ndarray = np.zeros(1, np.int64)
    parents: np.ndarray = np.array([-1])
    radius: np.ndarray = np.zeros(1)

    @property
    def rest(self) -> np.ndarray:
        return np.zeros((self.joints.shape[1] + 1, 3))

    @property
    def motion(self) -> "OtherTree":
        return self

    def carried(self, rest: np.ndarray) -> np.ndarray:
        return self.joints


def joints_at(*heights: float) -> FirstTree:
    """Of a cut whose joints are the true ones at these heights, or that far above the middle one."""
    true = body()
    places = [(HEIGHTS.index(z) if z in HEIGHTS else 1, z) for z in heights]
    joints = np.stack([true.R[:, k + 1] @ [0.0, 0.0, z] + true.t[:, k + 1] for k, z in places], axis=1)
    return cast(FirstTree, OtherTree(joints))


def heights(tree: FirstTree) -> list[float]:
    return sorted(tree.rest[1:, 2].round(1).tolist())
