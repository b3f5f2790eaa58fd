"""Bodies whose joints, parts and motion are known: a tube bent at chosen heights, and a pipe of three arms that swing."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from limbs import LENGTH, rotation, tube
from shapes import y_pipe
from shipped import TREE

from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut, TreeJoints, tree_joints
from kinetree.tasks.numerics.structure.unpaired_parts import UnpairedPartsSettings

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
ALL_STAY = TREE._replace(
    pruning=TREE.pruning._replace(
        degrees=0.0, ratio=0.0, flesh_length=0.0, trunk_length=0.0, unpaired=UnpairedPartsSettings(near=0.0, near_end=0.0)
    )
)
"""Settings with which no part is dropped."""


class Known(NamedTuple):
    """V, F and x as a step is given them, and the truth: label, weights, joints (part, xyz), parents, R and t of every part."""

    V: Floats
    F: Ints
    x: Floats
    label: Ints
    W: Floats
    joints: Floats
    parents: Ints
    R: Floats
    t: Floats

    @property
    def area(self) -> Floats:
        """(vertex,) a third of the faces around."""
        n = np.cross(self.V[self.F[:, 1]] - self.V[self.F[:, 0]], self.V[self.F[:, 2]] - self.V[self.F[:, 0]])
        return np.bincount(self.F.ravel(), np.repeat(np.linalg.norm(n, axis=1) / 6, 3), len(self.V))

    @property
    def residual(self) -> Floats:
        """(frame, part) nothing is left unexplained."""
        return np.zeros(self.R.shape[:2])


def swings(frames: int, parts: int, degrees: float = 30.0, axes: int = 2, seed: int = 0) -> Floats:
    """(frame, part, 3, 3) rotations against the parent; one axis is a hinge about x, two make a ball joint."""
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, (parts, 3))
    turn = np.broadcast_to(np.eye(3), (frames, parts, 3, 3)).copy()
    for f in range(frames):
        for p in range(parts):
            for k, axis in enumerate([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)][:axes]):
                angle = np.deg2rad(degrees) * np.sin(2 * np.pi * f * (k + 1 + p % 2) / frames + phase[p, k])
                turn[f, p] = turn[f, p] @ rotation(axis, angle)
    return turn


def moved(V: Floats, F: Ints, W: Floats, joints: Floats, parents: Ints, turn: Floats) -> Known:
    """The body with linear blend skinning; `turn` is of every part against its parent, the root's against space."""
    R, t = np.empty_like(turn), np.empty((*turn.shape[:2], 3))
    for p, above in enumerate(parents):
        R[:, p] = turn[:, p] if above < 0 else R[:, above] @ turn[:, p]
        where = joints[p] if above < 0 else R[:, above] @ joints[p] + t[:, above]
        t[:, p] = where - R[:, p] @ joints[p]
    x = np.einsum("vp,tpvx->tvx", W, np.einsum("tpxy,vy->tpvx", R, V) + t[:, :, None])
    return Known(V, F, x, W.argmax(axis=1), W, joints, parents, R, t)


def chain(
    heights: tuple[float, ...] = (0.0,), turn: Floats | None = None, blend: float = 0.0, around: int = 20, along: int = 40
) -> Known:
    """A tube along z from −5 to 5 of radius 1, bent at the heights; the lowest part is the root, which stays."""
    V, F = tube(around, along, flat=1.0)
    edge = np.concatenate([[-np.inf], heights, [np.inf]])
    width = max(blend, 1e-9)
    above = np.clip((V[:, 2:] - edge[None, :-1]) / width + 0.5, 0, 1)
    below = np.clip((V[:, 2:] - edge[None, 1:]) / width + 0.5, 0, 1)
    parts = len(heights) + 1
    joints = np.stack([np.zeros(parts), np.zeros(parts), np.array([-LENGTH / 4, *heights])], axis=1)
    if turn is None:
        turn = swings(24, parts)
    turn = turn.copy()
    turn[:, 0] = np.eye(3)
    return moved(V, F, above - below, joints, np.arange(parts) - 1, turn)


def and_at_rest(body: Known, frames: int) -> tuple[Known, list[slice]]:
    """The same body in two more takes of so many frames in which it stays as in the reference · all three takes."""
    first, rest = len(body.x), (body.V, np.broadcast_to(np.eye(3), body.R[0].shape), np.zeros(body.t[0].shape))
    x, R, t = (
        np.concatenate([a, np.broadcast_to(still, (2 * frames, *still.shape))])
        for a, still in zip((body.x, body.R, body.t), rest, strict=True)
    )
    takes = [slice(0, first), slice(first, first + frames), slice(first + frames, first + 2 * frames)]
    return body._replace(x=x, R=R, t=t), takes


def neck(half: float = 0.9, blend: float = 2.4) -> Known:
    """A chain of three parts whose middle one, short and under soft skin, moves hardly a vertex alone."""
    return chain((-half, half), swings(24, 3, seed=3), blend=blend, along=60)


def neck_ends(body: Known) -> TreeJoints:
    """The first and the last part of a chain as the only ones, as of a cut that missed those between."""
    ends, tips = [0, body.R.shape[1] - 1], np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    label = (body.V[:, 2] > 0.0).astype(np.int64)
    cut = Cut(body.V, label, body.R[:, ends], body.t[:, ends], body.residual[:, ends])
    return tree_joints(MovingSurface(body.V, body.F, body.x, body.area), cut, tips, settings=TREE)


def surface(body: Known) -> MovingSurface:
    return MovingSurface(body.V, body.F, body.x, body.area)


def cut_by_height(body: Known, heights: tuple[float, ...]) -> TreeJoints:
    """Parts between the heights, each with the rigid motion that explains its vertices best."""
    label = np.searchsorted(np.array(heights), body.V[:, 2])
    V = np.broadcast_to(body.V, body.x.shape)
    fits = [rigid_motion(V[:, label == p], body.x[:, label == p]) for p in range(len(heights) + 1)]
    R, t = (np.stack(of, axis=1) for of in zip(*fits, strict=True))
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    return tree_joints(surface(body), Cut(body.V, label, R, t, np.zeros(R.shape[:2])), tips, settings=ALL_STAY)


def three_arms(turn: Floats | None = None, reach: float = 12.0) -> Known:
    """A pipe of three arms of length 24 that turn at 12 from its middle, which is the root."""
    V, F, _ = y_pipe()
    way = np.stack([[np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3), 0.0] for k in range(3)])
    along = V @ way.T
    arm = np.where(along.max(axis=1) > reach, along.argmax(axis=1) + 1, 0)
    joints = np.concatenate([np.zeros((1, 3)), reach * way])
    if turn is None:
        turn = swings(24, 4)
    turn = turn.copy()
    turn[:, 0] = np.eye(3)
    return moved(V, F, np.eye(4)[arm], joints, np.array([-1, 0, 0, 0]), turn)
