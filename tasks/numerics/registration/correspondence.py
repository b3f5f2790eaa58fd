"""Which point of the body is which point of a frame: nearest neighbours in place and direction, (x, βn).

The direction keeps the two sides of a hand, or two limbs that touch, apart; 2014, §5.2 maps by geodesic coordinates
instead, which rings of a limb share. A search among the samples starts a fit; after that each match walks over the mesh
from neighbour to neighbour, which costs a twentieth.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.morton_curve import spread_along_curve
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import smoothed_normals

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

BETA = 0.08  # what a turn of the normal counts against distance, share of the body's size
COVERED = 0.0135  # a point of the frame is covered by a point of the body this near, share of the body's size
ALIKE = 0.3  # and whose normal has at least this cosine with its own
_STEPS = 64  # a walk is never longer


@dataclass(frozen=True)
class Target:
    """One frame prepared to be fitted.

    V, F   : (vertex, xyz) mesh unit · (face, corner)
    N      : (vertex, xyz) unit normals, smoothed
    start  : (vertex + 1,) where each vertex's neighbours begin in `ring`
    ring   : (entry,) neighbours, ascending
    sample : (sample,) vertices that stand for the surface
    tree   : search tree of (x, βn) of the samples
    beta   : β, mesh unit
    size   : of the reference body, mesh unit
    """

    V: Floats
    F: Ints
    N: Floats
    start: Ints
    ring: Ints
    sample: Ints
    tree: cKDTree
    beta: float
    size: float

    @classmethod
    def of(cls, V: Floats, F: npt.NDArray[np.integer[Any]], size: float, samples: int = 6000) -> "Target":
        """Prepare a frame.

        V, F    : (vertex, xyz) mesh unit · (face, corner) clean
        size    : of the reference body, mesh unit; not of this frame, which may lack a limb
        samples : vertices that stand for the surface, all if there are fewer
        """
        faces = F.astype(np.int64)
        N = smoothed_normals(V, faces)
        sample = spread_along_curve(V, samples)
        tree = cKDTree(np.hstack([V[sample], BETA * size * N[sample]]), balanced_tree=False)
        return cls(np.ascontiguousarray(V), faces, N, *rings(faces, len(V)), sample, tree, BETA * size, size)

    def found(self, x: Floats, n: Floats) -> Ints:
        """(point,) the sample nearest to each point in (x, βn)."""
        return self.sample[self.tree.query(np.hstack([x, self.beta * n]))[1]]


@compiled
def walked(x: Floats, n: Floats, match: Ints, V: Floats, N: Floats, start: Ints, ring: Ints, beta: float) -> Ints:
    """Each match moved over the mesh, neighbour by neighbour, while that brings it nearer in (x, βn).

    x, n        : (point, xyz) mesh unit · (point, xyz) unit
    match       : (point,) the vertex from which each walk starts
    V, N        : (vertex, xyz) mesh unit · (vertex, xyz) unit
    start, ring : neighbours of the vertices
    beta        : mesh unit
    returns     : (point,) the vertex where each walk ends
    """
    out = np.empty_like(match)
    turn = 2.0 * beta * beta  # |n − m|² = 2 − 2 n·m
    for i in range(len(match)):
        here, nearer, best = match[i], match[i], np.inf
        for step in range(_STEPS):
            for e in range(start[here] - (step == 0), start[here + 1]):
                u = ring[e] if e >= start[here] else here
                alike = n[i, 0] * N[u, 0] + n[i, 1] * N[u, 1] + n[i, 2] * N[u, 2]
                d = (x[i, 0] - V[u, 0]) ** 2 + (x[i, 1] - V[u, 1]) ** 2 + (x[i, 2] - V[u, 2]) ** 2 - turn * alike
                if d < best:
                    nearer, best = u, d
            if nearer == here and step > 0:
                break
            here = nearer
        out[i] = here
    return out


def covered(x: Floats, n: Floats, F: Ints, target: Target) -> npt.NDArray[np.bool_]:
    """Which samples of a frame have a point of the body near them that faces the same way.

    x, n    : (vertex, xyz) the body in this frame, mesh unit · (vertex, xyz) its unit normals
    F       : (face, corner) of the body
    returns : (sample,) True where covered
    """
    on = projected(target.V[target.sample], x, F)
    alike = np.einsum("pk,pkx,px->p", on.share, n[F[on.face]], target.N[target.sample])
    return (on.distance < COVERED * target.size) & (alike > ALIKE)


def uncovered(x: Floats, n: Floats, F: Ints, target: Target) -> float:
    """Share of a frame's surface that no point of the body explains: near 0, unless a limb sits on the wrong limb.

    x, n    : (vertex, xyz) the body in this frame, mesh unit · (vertex, xyz) its unit normals
    F       : (face, corner) of the body
    returns : 0 to 1
    """
    return 1.0 - float(covered(x, n, F, target).mean())
