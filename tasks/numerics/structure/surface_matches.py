"""What the surface of one frame says of an articulated body: which point should go where, and what is left unexplained.

Both ways. A point of the body looks for the nearest point of the frame that faces as it does, and believes it only if that
point's own nearest point of the body lies on the same part or one joined to it: where limbs touch, hidden surface finds the
other limb, whose own surface is nearer, and so says nothing; so does a limb that the frame has lost. A point of the frame
draws the nearest point of the body, whichever that is: surface that nothing explains is what calls back a limb.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.registration.correspondence import COVERED, Target, walked
from kinetree.tasks.numerics.structure.articulated_frame import Body, Posture, surface

ALIKE = 0.3  # cosine of two normals below which two points are not one
SIDEWAYS = 0.2  # what a way along the surface counts against one across it when matches are weighed
SLIDE = 0.05  # and when the surface is explained: vertices never lie on vertices


class Matches(NamedTuple):
    """The body against a frame.

    x, n : (vertex, xyz) the body's surface, mesh unit · its unit normals
    own  : (asked,) vertex of the frame that each asked vertex of the body finds
    mine : (asked,) whether it may believe it
    of   : (sample,) vertex of the body that each sample of the frame finds
    """

    x: Floats
    n: Floats
    own: Ints
    mine: Flags
    of: Ints


class Rows(NamedTuple):
    """Where vertices of the body should go.

    vertex       : (row,)
    d, n         : (row, xyz) from where each is, mesh unit · (row, xyz) unit normal of the plane that it should reach
    plane, point : (row,) weights of the way across that plane and of the way itself, mesh unit²
    """

    vertex: Ints
    d: Floats
    n: Floats
    plane: Floats
    point: Floats


def sought(body: Body, at: Posture, target: Target) -> Matches:
    """Searches everywhere."""
    x, n = surface(body, at)
    asked = body.asked
    tree = cKDTree(np.hstack([x[asked], target.beta * n[asked]]), balanced_tree=False)
    own = target.found(x[asked], n[asked])
    own = walked(x[asked], n[asked], own, target.V, target.N, target.start, target.ring, target.beta)
    both = np.concatenate([own, target.sample])
    back = asked[tree.query(np.hstack([target.V[both], target.beta * target.N[both]]))[1]]
    mine = body.meets[body.label[asked], body.label[back[: len(own)]]]
    of = walked(target.V[target.sample], target.N[target.sample], back[len(own) :], x, n, body.start, body.ring, target.beta)
    return Matches(x, n, own, mine, of)


def followed(body: Body, at: Posture, target: Target, last: Matches) -> Matches:
    """The same after a small step, from neighbour to neighbour."""
    x, n = surface(body, at)
    asked = body.asked
    own = walked(x[asked], n[asked], last.own, target.V, target.N, target.start, target.ring, target.beta)
    of = walked(target.V[target.sample], target.N[target.sample], last.of, x, n, body.start, body.ring, target.beta)
    return Matches(x, n, own, last.mine, of)


def rows(body: Body, target: Target, found: Matches, sigma: float, slack: float) -> Rows:
    """What is drawn where, with weights (n·n) / (1 + (d / σ)²)² of the area that each point stands for.

    d² is the square of the way across the surface and a fifth of that of the whole way.

    sigma : distance at which a point counts a quarter, mesh unit
    slack : weight of the way along the surface against that across it
    """
    a, s = body.asked, target.sample
    there = target.V[found.own] - found.x[a]
    here = target.V[s] - found.x[found.of]
    each = body.mass.sum() / max(len(s), 1)
    near = _weights(there, found.n[a], target.N[found.own], body.mass * found.mine, sigma)
    far = _weights(here, found.n[found.of], target.N[s], np.full(len(s), each), sigma)
    plane = np.concatenate([near, far])
    return Rows(
        np.concatenate([a, found.of]),
        np.concatenate([there, here]),
        np.concatenate([target.N[found.own], target.N[s]]),
        plane,
        slack * plane,
    )


def unexplained(body: Body, target: Target, found: Matches) -> Floats:
    """(sample,) 0 to 1: how far each sample of a frame is from being a point of the body, 1 from `COVERED` on.

    What faces another way explains nothing.
    """
    s = target.sample
    d = target.V[s] - found.x[found.of]
    across = np.einsum("sx,sx->s", d, found.n[found.of])
    away = (across**2 + SLIDE * (d**2).sum(axis=1)) / (COVERED * target.size) ** 2
    alike = np.einsum("sx,sx->s", found.n[found.of], target.N[s]) > ALIKE
    return np.where(alike, np.minimum(away, 1.0), 1.0)


def shown(body: Body, target: Target, found: Matches) -> Floats:
    """(part,) share of each part's surface that the frame shows where the body has it."""
    a = body.asked
    d = target.V[found.own] - found.x[a]
    across = np.einsum("sx,sx->s", d, target.N[found.own])
    away = (across**2 + SLIDE * (d**2).sum(axis=1)) / (COVERED * target.size) ** 2
    alike = np.einsum("sx,sx->s", found.n[a], target.N[found.own]) > ALIKE
    count = len(body.parents)
    seen = np.bincount(body.label[a], body.mass * (found.mine & alike) / (1.0 + away**2), count)
    return seen / np.maximum(np.bincount(body.label[a], body.mass, count), 1e-300)


@compiled
def _weights(d: Floats, n: Floats, m: Floats, mass: Floats, sigma: float) -> Floats:
    out = np.zeros(len(d))
    for i in range(len(d)):
        alike = n[i, 0] * m[i, 0] + n[i, 1] * m[i, 1] + n[i, 2] * m[i, 2]
        if alike > ALIKE and mass[i] > 0.0:
            across = m[i, 0] * d[i, 0] + m[i, 1] * d[i, 1] + m[i, 2] * d[i, 2]
            square = (across**2 + SIDEWAYS * (d[i, 0] ** 2 + d[i, 1] ** 2 + d[i, 2] ** 2)) / sigma**2
            out[i] = mass[i] * alike / (1.0 + square) ** 2
    return out
