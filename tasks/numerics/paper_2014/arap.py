"""As-rigid-as-possible deformation with a soft constraint at every vertex (Sorkine, Alexa 2007; 2014, Sec. 5.3).

E(x, R) = Σ_i [½ Σ_j w_ij |(x_i − x_j) − R_i (p_i − p_j)|² + c_i |x_i − q_i|²]: p is the rest position, q the target and x the
result. For fixed x the best R_i are found one by one; for fixed R the best x solves (L + C) x = b + C q, whose matrix is the
same in every frame.

The papers give no c. Here c_i = a_i / ℓ², a_i the area around a vertex: errors of the mapping over distances shorter than ℓ
are averaged, whatever the tessellation; over longer distances the mapping is followed.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.sparse import csc_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.cotangents import Links, cotangent_links
from kinetree.tasks.numerics.geometry.rigid_fit import turn_all, turn_towards


class Deformed(NamedTuple):
    """The mesh in one frame.

    x        : (vertex, xyz) mesh unit
    rotation : (vertex, row, xyz) R_i, from rest
    energy   : (step + 1,) E before the first step and after each, mesh unit²; never rises
    """

    x: Floats
    rotation: Floats
    energy: Floats


@dataclass(frozen=True)
class Factorised:
    """A reference mesh whose system is factorised once, for any number of frames.

    rest   : (vertex, xyz) p, mesh unit
    links  : neighbours and weights
    soft   : (vertex,) c, without unit
    anchor : (vertex,) 1 at one vertex of each connected component without any constraint, whose place is not determined;
             E does not change when a whole component is shifted
    solver : of (L + C) x = right-hand side
    size   : root of the mean squared distance from the vertices' centre, mesh unit; steps are measured by it
    """

    rest: Floats
    links: Links
    soft: Floats
    anchor: Floats
    solver: Any
    size: float

    @classmethod
    def of(cls, V: Floats, F: npt.NDArray[np.integer], soft: Floats) -> "Factorised":
        """Factorises (L + C) of a mesh at rest.

        V, F : (vertex, xyz) mesh unit · (face, corner)
        soft : (vertex,) c_i, not negative; `soft_weights` gives one for a length
        """
        links = cotangent_links(V, F)
        tail = np.repeat(np.arange(len(V)), np.diff(links.start))
        _, component = connected_components(csc_array((np.ones(len(tail)), (tail, links.ring)), shape=(len(V), len(V))))
        first = np.unique(component, return_index=True)[1]
        anchor = np.zeros(len(V))
        anchor[first] = np.bincount(component, soft) == 0.0
        diagonal = np.bincount(tail, links.weight, len(V)) + soft + anchor
        every = np.arange(len(V))
        matrix = csc_array(
            (np.r_[diagonal, -links.weight], (np.r_[every, tail], np.r_[every, links.ring])), shape=(len(V), len(V))
        )
        # positive definite: no pivoting, and an ordering made for symmetric matrices
        solver = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        rest = np.array(V, np.float64)
        size = float(np.sqrt(((rest - rest.mean(axis=0)) ** 2).sum(axis=1).mean()))
        return cls(rest, links, np.array(soft, np.float64), anchor, solver, size)

    def solve(self, target: Floats, start: Floats | None = None, steps: int = 100, tolerance: float = 1e-4) -> Deformed:
        """The mesh deformed as rigidly as possible towards the targets (Sorkine, Alexa 2007).

        target    : (vertex, xyz) q, mesh unit; anything finite where soft is 0
        start     : (vertex, xyz) initial positions, mesh unit; if not given, every vertex begins with the rotation of the
                    targets around it against rest, averaged over the length ℓ
        steps     : global steps at most
        tolerance : steps end when the vertices move by less than this share of the size, root mean square
        """
        q, R = np.array(target, np.float64), np.tile(np.eye(3), (len(self.rest), 1, 1))
        if start is None:
            self._rotate_as_targets(q, R)
        x = self._global_step(q, R, self.rest) if start is None else np.array(start, np.float64)
        anchored, energy = x, []
        for _ in range(steps):
            energy.append(_local_step(self.rest, *self.links, self.soft, q, x, R))
            before, x = x, self._global_step(q, R, anchored)
            if np.sqrt(((x - before) ** 2).sum(axis=1).mean()) < tolerance * self.size:
                break
        energy.append(_local_step(self.rest, *self.links, self.soft, q, x, R))
        return Deformed(x, R, np.array(energy))

    def _global_step(self, q: Floats, R: Floats, anchored: Floats) -> Floats:
        """The global step: the x of least energy for rotations R."""
        right = _right_hand_side(self.rest, *self.links, self.soft, q, R) + self.anchor[:, None] * anchored
        return np.ascontiguousarray(self.solver.solve(right))

    def _rotate_as_targets(self, q: Floats, R: Floats) -> None:
        """R of every vertex from the mean of q pᵀ around it: (L + C)⁻¹ C averages and has rows that sum to 1."""
        if not (self.soft > 0.0).any():
            return
        p = self.rest - self.rest.mean(axis=0)
        c = self.soft[:, None]
        products = (q[:, :, None] * p[:, None, :]).reshape(-1, 9)
        mean = self.solver.solve(c * np.concatenate([products, q, p], axis=1))
        H = mean[:, :9].reshape(-1, 3, 3) - mean[:, 9:12, None] * mean[:, None, 12:]
        turn_all(np.ascontiguousarray(H), R)


def soft_weights(area: Floats, length: float) -> Floats:
    """c_i = a_i / ℓ² for targets that are averaged over the length ℓ (ours; the papers give no weight).

    area    : (vertex,) mesh unit²
    length  : ℓ, mesh unit, above 0
    returns : (vertex,) without unit
    """
    return area / (length * length)


@compiled
def _local_step(p: Floats, start: Ints, ring: Ints, weight: Floats, soft: Floats, q: Floats, x: Floats, R: Floats) -> float:
    """The local step: R of least energy for positions x, changed in place; the energy with them."""
    energy, H = 0.0, np.empty((3, 3))
    e, f = np.empty(3), np.empty(3)
    for i in range(len(p)):
        lengths = distance = 0.0
        H[:] = 0.0
        for k in range(start[i], start[i + 1]):
            for a in range(3):
                e[a], f[a] = x[i, a] - x[ring[k], a], p[i, a] - p[ring[k], a]
                lengths += weight[k] * (e[a] * e[a] + f[a] * f[a])
            for a in range(3):
                for b in range(3):
                    H[a, b] += weight[k] * e[a] * f[b]
        for a in range(3):
            distance += (x[i, a] - q[i, a]) ** 2
        energy += 0.5 * lengths - turn_towards(H, R[i]) + soft[i] * distance
    return energy


@compiled
def _right_hand_side(p: Floats, start: Ints, ring: Ints, weight: Floats, soft: Floats, q: Floats, R: Floats) -> Floats:
    """(vertex, xyz) b + C q, b_i = Σ_j ½ w_ij (R_i + R_j)(p_i − p_j)."""
    out = np.empty((len(p), 3))
    for i in range(len(p)):
        for a in range(3):
            out[i, a] = soft[i] * q[i, a]
        for k in range(start[i], start[i + 1]):
            j = ring[k]
            for a in range(3):
                for b in range(3):
                    out[i, a] += 0.5 * weight[k] * (R[i, a, b] + R[j, a, b]) * (p[i, b] - p[j, b])
    return out
