"""How far a body is from one rigid body, by its surface alone and not by an alignment (ours, for 2014, Sec. 6.1.2)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion


class RigidResidualSettings(NamedTuple):
    """What noise and triangles explain. Not recorded on which bodies these were chosen."""

    noise: float = 0.004
    """Error of a reconstructed surface, share of the root of the area. Above it small turns of limbs are missed, below it noise
    is taken for motion."""
    edge_share: float = 0.35
    """Distance between two triangulations of one surface, share of the mean edge; an ample bound."""
    quantile: float = 0.98
    """Share of the vertices that must lie on the frame's surface; thin ends are cut differently in every frame."""
    rounds: int = 6
    """Rounds of the registration at most; each needs a search for nearest points."""
    hopeless: float = 8.0
    """Residual, in units of the bound, at which further rounds are not tried: the body moved for certain."""


def rigid_residual(
    rest: Floats, x: Floats, area: Floats, V: Floats, F: Ints, settings: RigidResidualSettings | None = None
) -> float:
    """How far the reference is off a frame's surface when it is moved as one rigid body; 1 is what noise and triangles explain.

    Begins with the rigid motion that fits the alignment best, and goes on by nearest points of the surface (Besl, McKay 1992).

    rest, x : (vertex, xyz) the reference, mesh unit · as aligned to the frame
    area    : (vertex,) mesh unit²; vertices with none do not count
    V, F    : (frame's vertex, xyz) mesh unit · (face, corner) the frame
    returns : the least residual of all rounds, without unit
    """
    settings = settings or RigidResidualSettings()
    counted = area > 0.0
    P, w, goal = rest[counted], area[counted] / area[counted].sum(), x[counted]
    size = float(np.sqrt(area.sum()))
    edge = float(np.linalg.norm(V[F[:, 0]] - V[F[:, 1]], axis=1).mean())
    bound = settings.noise * size + settings.edge_share * edge
    least = np.inf
    for _ in range(settings.rounds):
        R, t = rigid_motion(P, goal, w)
        moved = P @ R.T + t
        nearest = projected(moved, V, F)
        residual = float(np.quantile(nearest.distance, settings.quantile)) / bound
        least = min(least, residual)
        if least <= 1.0 or residual > settings.hopeless:
            break
        goal = np.einsum("vk,vkx->vx", nearest.share, V[F[nearest.face]])
    return least
