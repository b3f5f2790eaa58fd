"""A finished articulated body in one frame: where its surface goes, and how it moves when its parts turn a little (ours).

x_v = Σ_a w_va [R_a (v − rest_a) + X_a] and X_a = X_p + R_p (rest_a − rest_p): the body has bones of fixed length. Turning
part b by ω moves a vertex by ω × l_vb, with the lever l_vb = Σ w_va (x_va − X_b) over the parts a at or beyond b, where
x_va is the point X_a carries if a is b, and otherwise the joint that connects a's branch to b.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.registration.graph_kinematics import deformed, turned
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.frame_poses import fit_sample


class SkinnedBody(NamedTuple):
    """The body at rest.

    V, F, N       : (vertex, xyz) mesh unit · (face, corner) · (vertex, xyz) unit normals, smoothed
    start, ring   : neighbours of the vertices
    bound, weight : (vertex, 4) parts each vertex follows · how much, summing to 1
    label         : (vertex,) the part it follows most
    rest, parents : (part, xyz) the joint about which each turns, mesh unit · (part,) −1 for the first, parents first
    meets         : (part, part) the same part, or joined by a joint
    beyond        : (part, part) the second is the first or lies below it
    sample, mass  : (sample,) vertices that stand for the surface · (sample,) area of each, mesh unit²
    reach         : (part,) Σ mass |v − rest|² of a part's surface, mesh unit⁴
    size          : root of the area, mesh unit
    """

    V: Floats
    F: Ints
    N: Floats
    start: Ints
    ring: Ints
    bound: Ints
    weight: Floats
    label: Ints
    rest: Floats
    parents: Ints
    meets: Flags
    beyond: Flags
    sample: Ints
    mass: Floats
    reach: Floats
    size: float

    @classmethod
    def of(
        cls, V: Floats, F: npt.NDArray[np.integer[Any]], bound: npt.NDArray[np.integer[Any]], weight: Floats, rest: Floats,
        parents: Ints,
    ) -> "SkinnedBody":  # fmt: skip
        """A skinned mesh; see the class for the arrays."""
        V, rest, faces = np.array(V, dtype=np.float64), np.array(rest, dtype=np.float64), F.astype(np.int64)
        area = surface_areas(V, faces)
        label = bound[:, 0].astype(np.int64)
        count = len(parents)
        sample, mass = fit_sample(label, area, count)
        meets = np.eye(count, dtype=np.bool_)
        meets[np.arange(1, count), parents[1:]] = meets[parents[1:], np.arange(1, count)] = True
        reach: Floats = np.bincount(label, area * ((V - rest[label]) ** 2).sum(axis=1), count).astype(np.float64)
        return cls(
            V, faces, smoothed_normals(V, faces), *rings(faces, len(V)), bound.astype(np.int64),
            np.array(weight, dtype=np.float64), label, rest, parents, meets, beyond(parents) > 0, sample, mass, reach,
            float(np.sqrt(area.sum())),
        )  # fmt: skip

    @classmethod
    def of_joints(
        cls, V: Floats, F: npt.NDArray[np.integer[Any]], influence: npt.NDArray[np.integer[Any]], weight: Floats, rest: Floats,
        parents: Ints, moving: Ints,
    ) -> "SkinnedBody":  # fmt: skip
        """The body of a skeleton, whose arrays number joints; `moving` (part,) are those that carry a part."""
        above = parents[moving]
        parents = np.where(above >= 0, np.searchsorted(moving, above), -1)
        bound = np.where(weight > 0, np.searchsorted(moving, influence), 0)
        return cls.of(V, F, bound, weight, rest[moving], parents)


class FramePose(NamedTuple):
    """The pose of an articulated body in one frame.

    R : (part, 3, 3) from rest to the frame
    x : (xyz) the root's joint, mesh unit
    """

    R: Floats
    x: Floats


def joints(body: SkinnedBody, at: FramePose) -> Floats:
    """(part, xyz) where a pose puts the joints, mesh unit."""
    X = np.empty((len(body.parents), 3))
    X[0] = at.x
    for j in range(1, len(X)):
        p = body.parents[j]
        X[j] = X[p] + at.R[p] @ (body.rest[j] - body.rest[p])
    return X


def surface(body: SkinnedBody, at: FramePose) -> tuple[Floats, Floats]:
    """Linear blend skinning: (vertex, xyz) where a pose puts the surface, mesh unit · (vertex, xyz) its unit normals."""
    R = np.ascontiguousarray(at.R)
    x = deformed(body.V, body.bound, body.weight, body.rest, R, joints(body, at))
    return x, turned(body.N, body.bound, body.weight, R)


def parts_of_joints(parents: Sequence[int], kinds: Sequence[str]) -> tuple[Ints, Ints]:
    """(part,) joints that carry a part · (joint,) part that each joint turns with: a leaf turns with its parent's.

    parents, kinds : (joint,) −1 for the root · root, joint or leaf
    """
    moving = np.flatnonzero([kind != "leaf" for kind in kinds])
    carrier = [p if kind == "leaf" else j for j, (p, kind) in enumerate(zip(parents, kinds, strict=True))]
    return moving, np.searchsorted(moving, carrier)


def joints_of_parts(rest: Floats, parents: Sequence[int], kinds: Sequence[str], part: Ints, R: Floats, X: Floats) -> Floats:
    """Positions of all joints of a skeleton, leaves included, from the pose of its parts.

    rest, parents, kinds, part : (joint, …) see `parts_of_joints`
    R, X    : (part, 3, 3) · (part, xyz) rotations and joints of the parts, mesh unit
    returns : (joint, xyz) mesh unit
    """
    at = X[part].copy()
    for j, (p, kind) in enumerate(zip(parents, kinds, strict=True)):
        if kind == "leaf":
            at[j] = at[p] + R[part[j]] @ (rest[j] - rest[p])
    return at


def relative_rotations(R: Floats, parents: Ints) -> Floats:
    """(…, part, 3, 3) rotation R_pᵀ R_a of every part against its parent, from R (…, part, 3, 3); the root keeps its own."""
    turn = np.swapaxes(R[..., np.maximum(parents, 0), :, :], -1, -2) @ R
    turn[..., 0, :, :] = R[..., 0, :, :]
    return turn


def chained(turn: Floats, parents: Ints) -> Floats:
    """(part, 3, 3) rotations of the parts from those against their parents (part, 3, 3): undoes `relative_rotations`."""
    R = turn.copy()
    for j in range(1, len(parents)):
        R[j] = R[parents[j]] @ turn[j]
    return R


def limbs(parents: Ints, flagged: Flags) -> Ints:
    """(part,) number of the connected piece of the tree that each flagged part (part,) is in, −1 for the others."""
    piece = np.full(len(parents), -1)
    for j in np.flatnonzero(flagged):
        joined = parents[j] >= 0 and flagged[parents[j]]
        piece[j] = piece[parents[j]] if joined else piece.max() + 1
    return piece


@compiled
def add_equations(
    H: Floats, g: Floats, vertex: Ints, d: Floats, n: Floats, plane: Floats, point: Floats,
    V: Floats, bound: Ints, weight: Floats, rest: Floats, parents: Ints, R: Floats, X: Floats,
) -> None:  # fmt: skip
    """Adds Σ plane (n·(d − δx))² + point |d − δx|² to the normal equations of the turns of all parts, then the shift.

    H, g         : (3 part + 3, 3 part + 3) · (3 part + 3,) changed in place
    vertex, d, n : (row,) vertex of the body · (row, xyz) where it should go from where it is · (row, xyz) unit
    plane, point : (row,) weights, mesh unit²
    V, bound, weight, rest, parents : see `SkinnedBody`
    R, X         : (part, 3, 3) · (part, xyz) the pose and its joints
    """
    P = len(parents)
    lever, J = np.zeros((P, 3)), np.empty((P, 3))
    used, is_used = np.zeros(P, np.int64), np.zeros(P, np.bool_)
    for i in range(len(vertex)):
        if plane[i] + point[i] <= 0.0:
            continue
        v, count = vertex[i], 0
        for k in range(bound.shape[1]):
            w, a = weight[v, k], bound[v, k]
            if w <= 0.0:
                continue
            if not is_used[a]:
                is_used[a], used[count], count = True, a, count + 1
            for x in range(3):
                for y in range(3):
                    lever[a, x] += w * R[a, x, y] * (V[v, y] - rest[a, y])
            while parents[a] >= 0:
                b = parents[a]
                if not is_used[b]:
                    is_used[b], used[count], count = True, b, count + 1
                for x in range(3):
                    lever[b, x] += w * (X[a, x] - X[b, x])
                a = b
        _add_row(H, g, lever, J, used, count, d[i], n[i], plane[i], point[i], P)
        for k in range(count):
            is_used[used[k]] = False
            for x in range(3):
                lever[used[k], x] = 0.0
    for i in range(3 * P):
        for j in range(i - i % 3):
            H[j, i] = H[i, j]


@compiled
def _add_row(
    H: Floats, g: Floats, lever: Floats, J: Floats, used: Ints, count: int, d: Floats, n: Floats, plane: float, point: float,
    P: int,
) -> None:  # fmt: skip
    """Adds the equation of one vertex, from the levers of the parts that move it, below the diagonal of H.

    J : (part, xyz) working space
    """
    off = n[0] * d[0] + n[1] * d[1] + n[2] * d[2]
    for k in range(count):
        a, r = used[k], lever[used[k]]
        for x in range(3):
            y, z = (x + 1) % 3, (x + 2) % 3
            J[k, x] = r[y] * n[z] - r[z] * n[y]
            g[3 * a + x] += plane * off * J[k, x] + point * (r[y] * d[z] - r[z] * d[y])
            for s in range(3):
                H[3 * a + x, 3 * P + s] += plane * J[k, x] * n[s]
            H[3 * a + x, 3 * P + z] += point * r[y]
            H[3 * a + x, 3 * P + y] -= point * r[z]
    for k in range(count):
        a = used[k]
        r0, r1, r2 = lever[a, 0], lever[a, 1], lever[a, 2]
        p0, p1, p2 = plane * J[k, 0], plane * J[k, 1], plane * J[k, 2]
        for m in range(k + 1):
            b = used[m]
            o0, o1, o2 = lever[b, 0], lever[b, 1], lever[b, 2]
            j0, j1, j2 = J[m, 0], J[m, 1], J[m, 2]
            q0, q1, q2, whole = point * o0, point * o1, point * o2, point * (r0 * o0 + r1 * o1 + r2 * o2)
            own = (
                (p0 * j0 - q0 * r0 + whole, p0 * j1 - q0 * r1, p0 * j2 - q0 * r2),
                (p1 * j0 - q1 * r0, p1 * j1 - q1 * r1 + whole, p1 * j2 - q1 * r2),
                (p2 * j0 - q2 * r0, p2 * j1 - q2 * r1, p2 * j2 - q2 * r2 + whole),
            )
            i, j = 3 * a, 3 * b
            if a >= b:
                for x in range(3):
                    for y in range(3):
                        H[i + x, j + y] += own[x][y]
            else:
                for x in range(3):
                    for y in range(3):
                        H[j + y, i + x] += own[x][y]
    for x in range(3):
        g[3 * P + x] += plane * off * n[x] + point * d[x]
        H[3 * P + x, 3 * P + x] += point
        for y in range(3):
            H[3 * P + x, 3 * P + y] += plane * n[x] * n[y]
