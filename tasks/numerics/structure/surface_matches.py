"""Matches between an articulated body and the surface of one frame, in both directions, and what they leave uncovered (ours).

A point of the body is matched to the nearest point of the frame that faces as it does. The match counts only if that point's
own nearest point of the body lies on the same part or one joined to it: where limbs touch, hidden surface finds the other
limb, whose own surface is nearer, and so has no match; nor has a limb that the frame has lost. A point of the frame is matched
to the nearest point of the body, whichever that is: uncovered surface is what draws a limb back.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.registration.correspondence import CorrespondenceSettings, Target, local_matches
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, SkinnedBody, surface


class SurfaceMatchesSettings(NamedTuple):
    """Which points match."""

    least_cosine: float = 0.3
    """Cosine of two normals below which two points do not match. Not recorded."""
    along: float = 0.2
    """Weight of a distance along the surface against one across it when matches are weighed. Not recorded."""
    along_covered: float = 0.05
    """The same when it is asked whether a point is covered: vertices never lie on vertices. Not recorded."""


class Matches(NamedTuple):
    """Matches of a body with a frame.

    x, n     : (vertex, xyz) the body's surface, mesh unit · its unit normals
    forward  : (body sample,) vertex of the frame that each sampled vertex of the body finds
    mutual   : (body sample,) whether that match counts
    backward : (frame sample,) vertex of the body that each sample of the frame finds
    """

    x: Floats
    n: Floats
    forward: Ints
    mutual: Flags
    backward: Ints


class MatchEquations(NamedTuple):
    """Where vertices of the body should go.

    vertex       : (row,)
    d, n         : (row, xyz) from where each is, mesh unit · (row, xyz) unit normal of the plane that it should reach
    plane, point : (row,) weights of the distance across that plane and of the distance itself, mesh unit²
    """

    vertex: Ints
    d: Floats
    n: Floats
    plane: Floats
    point: Floats


def searched(body: SkinnedBody, pose: FramePose, target: Target) -> Matches:
    """The matches of a pose with a frame, searched everywhere."""
    x, n = surface(body, pose)
    s = body.sample
    tree = cKDTree(np.hstack([x[s], target.beta * n[s]]), balanced_tree=False)
    forward = target.nearest(x[s], n[s])
    forward = local_matches(x[s], n[s], forward, target.V, target.N, target.start, target.ring, target.beta)
    # many points of the body find the same vertex: each is asked for once
    asked, back = np.zeros(len(target.V), np.bool_), np.empty(len(target.V), np.int64)
    asked[forward] = asked[target.sample] = True
    back[asked] = s[tree.query(np.hstack([target.V[asked], target.beta * target.N[asked]]))[1]]
    mutual = body.meets[body.label[s], body.label[back[forward]]]
    V, N = target.V[target.sample], target.N[target.sample]
    backward = local_matches(V, N, back[target.sample], x, n, body.start, body.ring, target.beta)
    return Matches(x, n, forward, mutual, backward)


def followed(body: SkinnedBody, pose: FramePose, target: Target, last: Matches) -> Matches:
    """The matches after a small step, each followed from neighbour to neighbour; which of them count stays."""
    x, n = surface(body, pose)
    s = body.sample
    forward = local_matches(x[s], n[s], last.forward, target.V, target.N, target.start, target.ring, target.beta)
    V, N = target.V[target.sample], target.N[target.sample]
    backward = local_matches(V, N, last.backward, x, n, body.start, body.ring, target.beta)
    return Matches(x, n, forward, last.mutual, backward)


def equations(
    body: SkinnedBody,
    target: Target,
    found: Matches,
    sigma: float,
    slack: float,
    settings: SurfaceMatchesSettings | None = None,
) -> MatchEquations:
    """Equations of all matches, with weights (n·n) / (1 + (d / σ)²)² of the area that each point stands for (ours).

    d² is the squared distance across the surface plus a share (`along`) of the whole squared distance.

    sigma : distance at which a match counts a quarter, mesh unit
    slack : weight of the distance itself against that across the surface
    """
    chosen = settings or SurfaceMatchesSettings()
    b, s = body.sample, target.sample
    there = target.V[found.forward] - found.x[b]
    here = target.V[s] - found.x[found.backward]
    each = np.full(len(s), body.mass.sum() / max(len(s), 1))
    limits = (sigma, chosen.least_cosine, chosen.along)
    near = _weights(there, found.n[b], target.N[found.forward], body.mass * found.mutual, *limits)
    far = _weights(here, found.n[found.backward], target.N[s], each, *limits)
    plane = np.concatenate([near, far])
    return MatchEquations(
        np.concatenate([b, found.backward]),
        np.concatenate([there, here]),
        np.concatenate([target.N[found.forward], target.N[s]]),
        plane,
        slack * plane,
    )


def uncovered(body: SkinnedBody, target: Target, found: Matches, settings: SurfaceMatchesSettings | None = None) -> Floats:
    """How far each sample of a frame is from being a point of the body.

    returns : (frame sample,) 0 to 1, 1 from `CorrespondenceSettings.covered` on, and where the body faces another way
    """
    chosen = settings or SurfaceMatchesSettings()
    s = target.sample
    d = target.V[s] - found.x[found.backward]
    across = np.einsum("sx,sx->s", d, found.n[found.backward])
    away = (across**2 + chosen.along_covered * (d**2).sum(axis=1)) / (CorrespondenceSettings().covered * target.size) ** 2
    alike = np.einsum("sx,sx->s", found.n[found.backward], target.N[s]) > chosen.least_cosine
    return np.where(alike, np.minimum(away, 1.0), 1.0)


def visible_share(body: SkinnedBody, target: Target, found: Matches, settings: SurfaceMatchesSettings | None = None) -> Floats:
    """(part,) share of each part's surface that the frame shows where the body has it, 0 to 1."""
    chosen = settings or SurfaceMatchesSettings()
    b = body.sample
    d = target.V[found.forward] - found.x[b]
    across = np.einsum("sx,sx->s", d, target.N[found.forward])
    away = (across**2 + chosen.along_covered * (d**2).sum(axis=1)) / (CorrespondenceSettings().covered * target.size) ** 2
    alike = np.einsum("sx,sx->s", found.n[b], target.N[found.forward]) > chosen.least_cosine
    count = len(body.parents)
    seen = np.bincount(body.label[b], body.mass * (found.mutual & alike) / (1.0 + away**2), count)
    return seen / np.maximum(np.bincount(body.label[b], body.mass, count), 1e-300)


@compiled
def _weights(d: Floats, n: Floats, m: Floats, mass: Floats, sigma: float, least_cosine: float, along: float) -> Floats:
    """(match,) weights of matches with offset d, normals n and m, and the area that each stands for."""
    out = np.zeros(len(d))
    for i in range(len(d)):
        cosine = n[i, 0] * m[i, 0] + n[i, 1] * m[i, 1] + n[i, 2] * m[i, 2]
        if cosine > least_cosine and mass[i] > 0.0:
            across = m[i, 0] * d[i, 0] + m[i, 1] * d[i, 1] + m[i, 2] * d[i, 2]
            square = (across**2 + along * (d[i, 0] ** 2 + d[i, 1] ** 2 + d[i, 2] ** 2)) / sigma**2
            out[i] = mass[i] * cosine / (1.0 + square) ** 2
    return out
