"""The motion of a bone that blends with others wherever skin follows it: weights and motion by turns (ours).

With the motion known the weights of each vertex are least squares on a simplex; with these known the motion is a rigid fit to
what the other parts leave of the skin, each vertex by the square of its weight.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.rigid_fit import MOMENTS, added, motion, rigid_motion
from kinetree.tasks.numerics.structure.skinning import grams, on_simplex

FAINT = 1e-3
"""Weight of the bone up to which a vertex says nothing of its motion."""


class MovingSkin(NamedTuple):
    """Skin in motion, and the parts that it follows.

    V, x : (vertex, xyz), (frame, vertex, xyz) mesh unit
    area : (vertex,) mesh unit²
    W    : (vertex, part) skinning weights
    R, t : (frame, part, 3, 3) · (frame, part, xyz) from the reference
    """

    V: Floats
    x: Floats
    area: Floats
    W: Floats
    R: Floats
    t: Floats

    def of(self, vertices: Ints, parts: Ints, frames: slice) -> "MovingSkin":
        """Some vertices in some frames, as if they followed these parts alone."""
        around = self.W[np.ix_(vertices, parts)]
        moved = (np.ascontiguousarray(a[frames][:, parts]) for a in (self.R, self.t))
        x = np.ascontiguousarray(self.x[frames][:, vertices])
        return MovingSkin(self.V[vertices], x, self.area[vertices], around / around.sum(axis=1, keepdims=True), *moved)

    def with_bone(self, R: Floats, t: Floats, weight: float) -> "MovingSkin":
        """The same with one more part (frame, 3, 3) · (frame, xyz), the last, which has this share of every vertex."""
        W = np.pad((1.0 - weight) * self.W, ((0, 0), (0, 1)), constant_values=weight)
        R, t = np.concatenate([self.R, R[:, None]], axis=1), np.concatenate([self.t, t[:, None]], axis=1)
        return self._replace(W=W, R=R, t=t)

    def weighed(self, hold: float) -> "MovingSkin":
        """The same with the weights that explain the skin best, held near those it has; hold, mesh unit²."""
        every, parts = np.zeros(len(self.V), np.int64), np.arange(self.R.shape[1])[None]
        H, g = grams(self.V, self.x, self.R, self.t, every, parts, np.ones(self.x.shape[:2]))
        return self._replace(W=on_simplex(H, g, np.full(len(self.V), hold), self.W, np.full(len(self.V), parts.shape[1])))

    def squares(self) -> Floats:
        """(frame, vertex) squared distance between the skin and where its parts carry it, mesh unit²."""
        return _squares(self.V, self.x, self.R, self.t, self.W)

    def bone_residual(self) -> Floats:
        """(frame,) root mean square of what is left unexplained where the skin follows the last part, mesh unit."""
        mass = self.area * self.W[:, -1]
        return np.asarray(np.sqrt(self.squares() @ mass / max(mass.sum(), 1e-300)))

    def least_explained(self, width: float) -> tuple[Floats, Floats]:
        """(frame, 3, 3) · (frame, xyz) the rigid motion of the skin around the vertex that the parts explain least.

        width : of these surroundings, mesh unit
        """
        away = np.linalg.norm(self.V - self.V[self.squares().sum(axis=0).argmax()], axis=1)
        weight = self.area * (np.exp(-((away / width) ** 2)) + 1e-12)
        return rigid_motion(np.broadcast_to(self.V, self.x.shape), self.x, np.tile(weight, (len(self.x), 1)))


def blended_bone(skin: MovingSkin, hold: float, rounds: int) -> MovingSkin:
    """The same skin with the motion of its last part, the bone, and all weights fitted by turns.

    hold   : mesh unit², how firmly weights stay from round to round
    rounds : of weights and motion, at most; fewer where no skin follows the bone any more
    """
    for _ in range(rounds):
        skin = skin.weighed(hold)
        if skin.area @ skin.W[:, -1] ** 2 < 1e-6 * skin.area.sum():
            break
        skin = refitted(skin)
    return skin.weighed(hold)


def refitted(skin: MovingSkin) -> MovingSkin:
    """The same skin with the rigid motion of its last part that explains it best, weights and other parts as they are."""
    R, t = skin.R.copy(), skin.t.copy()
    follows = skin.area * skin.W[:, -1] ** 2
    middle = follows @ skin.V / max(follows.sum(), np.finfo(float).tiny)
    _refit(skin.V, skin.x, skin.W, skin.area, middle, R, t)
    return skin._replace(R=R, t=t)


def refitted_about(skin: MovingSkin, joint: Floats) -> MovingSkin:
    """The same as `refitted`, its joints with the first parts kept together: each counts as much as the skin that follows it.

    joint : (side, xyz) with the first, second … part, in the reference, mesh unit
    """
    sides = len(joint)
    x = (skin.R[:, :sides] @ joint[None, :, :, None])[..., 0] + skin.t[:, :sides]
    W = np.zeros((sides, skin.W.shape[1]))
    W[:, -1] = 1.0
    firm = np.full(sides, float(skin.area @ skin.W[:, -1] ** 2))
    whole = refitted(
        skin._replace(
            V=np.concatenate([skin.V, joint]),
            x=np.concatenate([skin.x, x], axis=1),
            area=np.concatenate([skin.area, firm]),
            W=np.concatenate([skin.W, W]),
        )
    )
    return skin._replace(R=whole.R, t=whole.t)


@compiled
def _refit(V: Floats, x: Floats, W: Floats, area: Floats, middle: Floats, R: Floats, t: Floats) -> None:
    """Writes the motion of the last part; middle (xyz,) of the skin that follows it, other arrays as in `MovingSkin`."""
    bone = W.shape[1] - 1
    near, wanted, there = V - middle, np.empty((1, len(V), 3)), np.empty(3)
    for f in range(len(x)):
        m = np.zeros(MOMENTS)
        for i in range(3):
            there[i] = t[f, 0, i] + R[f, 0, i, 0] * middle[0] + R[f, 0, i, 1] * middle[1] + R[f, 0, i, 2] * middle[2]
        for v in range(len(V)):
            own = W[v, bone]
            if own <= FAINT:
                continue
            for i in range(3):
                wanted[0, v, i] = (x[f, v, i] - _carried(V, R, t, W, f, v, i, bone)) / own - there[i]
            added(m, near, wanted, 0, v, area[v] * own * own)
        motion(m, R[f, bone], t[f, bone])
        for i in range(3):
            turned = R[f, bone, i, 0] * middle[0] + R[f, bone, i, 1] * middle[1] + R[f, bone, i, 2] * middle[2]
            t[f, bone, i] += there[i] - turned


@compiled
def _squares(V: Floats, x: Floats, R: Floats, t: Floats, W: Floats) -> Floats:
    """See `MovingSkin.squares`."""
    out = np.zeros((len(x), len(V)))
    for f in range(len(x)):
        for v in range(len(V)):
            for i in range(3):
                out[f, v] += (x[f, v, i] - _carried(V, R, t, W, f, v, i, W.shape[1])) ** 2
    return out


@compiled
def _carried(V: Floats, R: Floats, t: Floats, W: Floats, f: int, v: int, i: int, parts: int) -> float:
    """Coordinate i of vertex v in frame f as the first so many parts carry it, by its weights."""
    total = 0.0
    for k in range(parts):
        y = t[f, k, i] + R[f, k, i, 0] * V[v, 0] + R[f, k, i, 1] * V[v, 1] + R[f, k, i, 2] * V[v, 2]
        total += W[v, k] * y
    return total
