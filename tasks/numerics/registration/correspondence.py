"""Which point of the body is which point of a frame: nearest neighbours in place and direction, (x, βn).

The direction keeps the two sides of a hand, or two limbs that touch, apart; 2014, §5.2 maps by geodesic coordinates
instead, which all points of a ring around a limb share. The first steps of a fit search among all samples; later ones start
from the last match and search over the mesh, which costs a twentieth.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.edge_rings import averaged_normals, edge_rings
from kinetree.tasks.numerics.geometry.morton_curve import spread_along_curve
from kinetree.tasks.numerics.registration.colour_term import FrameColour, gradient_of_noise

_STEPS = 64
"""Safety bound: a match moves over at most so many edges."""


class CorrespondenceSettings(NamedTuple):
    """How positions and normals are compared, and when a sample of a frame is covered by the body."""

    beta: float = 0.08
    """β, what a turn of the normal by one radian counts against distance, share of √area. Chosen on: not recorded. With a
    larger one matches slide along the surface, with a smaller one they jump between limbs that are close."""
    covered: float = 0.0135
    """A sample of the frame is covered by a point of the body this near, share of √area. Chosen on: not recorded."""
    cosine: float = 0.3
    """A point covers a sample if the cosine between their normals exceeds this. Chosen on: not recorded."""


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
    size   : √area of the reference body, mesh unit
    colour : of the frame and of the body, None where one of them has none
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
    colour: FrameColour | None = None

    @classmethod
    def of(
        cls,
        V: Floats,
        F: npt.NDArray[np.integer[Any]],
        size: float,
        samples: int = 6000,
        settings: CorrespondenceSettings | None = None,
        *,
        colour: FrameColour | None = None,
    ) -> "Target":
        """Prepare a frame (ours).

        V, F    : (vertex, xyz) mesh unit · (face, corner) clean
        size    : √area of the reference body, mesh unit; not of this frame, which may lack a limb
        samples : vertices that stand for the surface, all if there are fewer
        colour  : of the frame and of the body, None where one of them has none
        returns : Target
        """
        settings = settings or CorrespondenceSettings()
        beta = settings.beta * size
        faces = F.astype(np.int64)
        start, ring, count = edge_rings(faces, len(V))
        N = averaged_normals(V, faces, start, ring, count)
        sample = spread_along_curve(V, samples)
        tree = cKDTree(np.hstack([V[sample], beta * N[sample]]), balanced_tree=False)
        return cls(np.ascontiguousarray(V), faces, N, start, ring, sample, tree, beta, size, colour)

    @cached_property
    def colour_noise(self) -> float:
        """What noise of single vertices makes of the frame's colours, see `gradient_of_noise`; 0 without colours."""
        return 0.0 if self.colour is None else gradient_of_noise(self.V, self.colour.frame, self.start, self.ring)

    def nearest(self, x: Floats, n: Floats) -> Ints:
        """The sample of the frame that is nearest to each point in (x, βn).

        x, n    : (point, xyz) mesh unit · (point, xyz) unit
        returns : (point,) vertex numbers of the frame
        """
        return self.sample[self.tree.query(np.hstack([x, self.beta * n]))[1]]


@compiled
def local_matches(x: Floats, n: Floats, match: Ints, V: Floats, N: Floats, start: Ints, ring: Ints, beta: float) -> Ints:
    """Local nearest neighbours: each match moves over the mesh, edge by edge, while that brings it nearer in (x, βn) (ours).

    x, n        : (point, xyz) mesh unit · (point, xyz) unit
    match       : (point,) the vertex at which each search starts
    V, N        : (vertex, xyz) mesh unit · (vertex, xyz) unit
    start, ring : (vertex + 1,) · (entry,) neighbours of the vertices, see `edge_rings`
    beta        : mesh unit
    returns     : (point,) the vertex at which it ends
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


def covered_samples(x: Floats, n: Floats, F: Ints, target: Target, settings: CorrespondenceSettings | None = None) -> Flags:
    """Which samples of a frame have a point of the body near them whose normal agrees with theirs (ours).

    x, n    : (vertex, xyz) the body in this frame, mesh unit · (vertex, xyz) its unit normals
    F       : (face, corner) of the body
    target  : the frame
    returns : (sample,) True where covered
    """
    settings = settings or CorrespondenceSettings()
    on = projected(target.V[target.sample], x, F)
    cosine = np.einsum("pk,pkx,px->p", on.share, n[F[on.face]], target.N[target.sample])
    return (on.distance < settings.covered * target.size) & (cosine > settings.cosine)


def uncovered(x: Floats, n: Floats, F: Ints, target: Target) -> float:
    """Share of a frame's surface that the body does not explain: near 0, unless a limb lies on the wrong limb (ours).

    x, n    : (vertex, xyz) the body in this frame, mesh unit · (vertex, xyz) its unit normals
    F       : (face, corner) of the body
    target  : the frame
    returns : 0 to 1
    """
    return 1.0 - float(covered_samples(x, n, F, target).mean())
