"""Whether a body moved at all, by its surface alone, whatever an alignment makes of it (ours, for 2014, Sec. 6.1.2)."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

NOISE = 0.004
"""What a reconstruction errs by, share of the root of the area."""
SAG = 0.35
"""By what share of an edge's length triangles miss what they were cut from, amply."""
MOST = 0.98
"""Share of the vertices that must lie on the frame's surface: thin ends are cut differently in every frame."""
ROUNDS = 6
"""Times that the rigid motion is found anew; a body that moves is known for one at once."""


def rigid_gap(rest: Floats, x: Floats, area: Floats, V: Floats, F: Ints) -> float:
    """How far the reference stays off a frame's surface when it is moved as one rigid body, 1 being what noise explains.

    Begins with the motion that fits an alignment best, whose errors cancel over the body, and goes on by nearest points of
    the surface (Besl, McKay 1992).

    rest, x : (vertex, xyz) the reference, mesh unit · as aligned to the frame
    area    : (vertex,) mesh unit²; vertices with none do not count
    V, F    : (source, xyz) · (face, corner) the frame
    """
    mine = area > 0.0
    P, w, goal = rest[mine], area[mine] / area[mine].sum(), x[mine]
    size = float(np.sqrt(area.sum()))
    edge = float(np.linalg.norm(V[F[:, 0]] - V[F[:, 1]], axis=1).mean())
    noise = NOISE * size + SAG * edge
    least = np.inf
    for _ in range(ROUNDS):
        R, t = rigid_motion(P, goal, w)
        moved = P @ R.T + t
        there = projected(moved, V, F)
        gap = float(np.quantile(there.distance, MOST)) / noise
        least = min(least, gap)
        if least <= 1.0 or gap > 8.0:
            break
        goal = np.einsum("vk,vkx->vx", there.share, V[F[there.face]])
    return least
