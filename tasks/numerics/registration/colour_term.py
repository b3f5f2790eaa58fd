"""Colours as a term of a fit: matches nearest in place, normal and colour, held along the gradient of colour.

A geometric match may slide on its plane. Where colour changes along the surface, it says where on the plane the point lies:
with c(y) and its gradient G at the match, E = κ |c(y) + G (x − y) − c(v)|² (Park, Zhou and Koltun 2017, Eq. 8, all channels).
Frames differ in exposure and light. So a frame's colours are first explained by those of the body and by the normals now and at
rest (distant light; first order of Ramamoorthi and Hanrahan 2001). What the body's colours add to what normals explain is the
agreement: without it there is no term. Colours are compared as sRGB, in which the noise of 8-bit pictures is even and exposure
is nearly a gain.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled

_MEDIAN = 2.366
"""Of χ² with three degrees of freedom."""
_STEPS = 64
"""Safety bound: a match moves over at most so many edges."""


class ColourSettings(NamedTuple):
    """How colours count beside place and normal, and from which agreement on."""

    agreement: float = 0.2
    """Share of the variance of a frame's colours, beyond normals, that those of the body must explain: 0.9 and more on
    patterned clothes, below 0.05 with noise, or with light on plain ones."""
    least_noise: float = 0.02
    """Standard deviation of colours that agree perfectly, sRGB: 8 bits, and light that is not distant."""
    search: float = 0.01
    """What one standard deviation of colour counts against distance in the search for matches, share of √area."""
    hold: float = 0.0015
    """What it counts against distance from the plane in the energy, share of √area. Chosen, with `chance`, on a walking human
    and a random tree of 3,000 vertices: with 0.004 noise of colours pulls points, with 0.0005 they slide more."""
    chance: float = 2.0
    """So many times the gradient that noise of single vertices makes, see `gradient_of_noise`, is taken off."""
    outlier: float = 3.0
    """Standard deviations at which a match counts a quarter."""
    firmest: float = 1.0
    """Most that a match is held along the surface, share of what holds it on its plane."""
    matches: int = 2000
    """Matches from which the agreement is measured."""


@dataclass(frozen=True)
class FrameColour:
    """Colours of a frame beside those of the body.

    frame : (vertex, rgb) of the frame's mesh, sRGB from 0 to 1
    body  : (vertex, rgb) of the reference mesh
    """

    frame: Floats
    body: Floats


class Compared(NamedTuple):
    """Colours of a frame and of the body as they compare: light and exposure of the frame explained.

    body  : (vertex, rgb) the body's as they would be in this frame
    frame : (vertex, rgb) the frame's without what its normals explain
    share : of the variance that normals leave, what the body's colours explain, 0 to 1
    noise : standard deviation of what is left
    """

    body: Floats
    frame: Floats
    share: float
    noise: float


def compared(
    colour: FrameColour, rest: Floats, now: Floats, vertex: Ints, other: Ints, settings: ColourSettings | None = None
) -> Compared:
    """How a frame's colours follow from the body's: least squares over matches, twice, then without outliers (ours).

    rest, now     : (vertex, xyz) normals of the body at rest, and of the frame
    vertex, other : (match,) the body's vertex and the frame's
    returns       : Compared
    """
    settings = settings or ColourSettings()
    thin = slice(None, None, max(len(vertex) // settings.matches, 1))
    v, u = vertex[thin], other[thin]
    seen = colour.frame[u]
    A = np.hstack([np.ones((len(v), 1)), now[u], rest[v], colour.body[v]])
    keep = np.ones(len(v), dtype=np.bool_)
    for _ in range(2):
        x = _least_squares(A[keep], seen[keep])
        square = ((seen - A @ x) ** 2).sum(axis=1)
        keep = square <= 12.0 * max(float(np.median(square)), 1e-9)
    without = _least_squares(A[keep, :7], seen[keep])
    plain = ((seen[keep] - A[keep, :7] @ without) ** 2).sum()
    share = 1.0 - float(square[keep].sum()) / max(float(plain), 1e-12)
    noise = max(float(np.sqrt(np.median(square) / _MEDIAN)), settings.least_noise)
    return Compared(x[0] + rest @ x[4:7] + colour.body @ x[7:], colour.frame - now @ x[1:4], share, noise)


def _least_squares(A: Floats, b: Floats) -> Floats:
    """Least squares by the normal equations, with so little on their diagonal that columns may be one another's multiples."""
    M = A.T @ A
    return np.asarray(np.linalg.solve(M + 1e-10 * np.trace(M) * np.eye(len(M)), A.T @ b))


def surface_gradient(V: Floats, N: Floats, colour: Floats, start: Ints, ring: Ints) -> Floats:
    """Gradient of colours along the surface, by least squares over each vertex's neighbours (ours).

    V, N        : (vertex, xyz) mesh unit · (vertex, xyz) unit
    colour      : (vertex, rgb)
    start, ring : see `edge_rings`
    returns     : (vertex, rgb, xyz) per mesh unit, at right angles to the normal
    """
    return _gradient(V, N, np.ascontiguousarray(colour), start, ring)


def gradient_of_noise(V: Floats, colour: Floats, start: Ints, ring: Ints) -> float:
    """Mean |G|² that noise of single vertices gives `surface_gradient`: 2 σ² / ℓ², for six neighbours at ℓ (ours).

    σ² is the median square of what a vertex differs from the mean of its neighbours, which colours that are linear do not.

    V, colour   : (vertex, xyz) mesh unit · (vertex, rgb)
    start, ring : see `edge_rings`
    returns     : per mesh unit²
    """
    count = np.maximum(np.diff(start), 1)
    around = csr_array((np.ones(len(ring)), ring, start), shape=(len(V), len(V)))
    own = ((colour - (around @ colour) / count[:, None]) ** 2).sum(axis=1)
    variance = float(np.median(own)) / (_MEDIAN * (1.0 + 1.0 / 6.0))
    edge = V[ring] - np.repeat(V, np.diff(start), axis=0)
    return 2.0 * variance / max(float(np.einsum("ex,ex->e", edge, edge).mean()), 1e-30)


@compiled
def feature_matches(P: Floats, match: Ints, Q: Floats, start: Ints, ring: Ints) -> Ints:
    """Local nearest neighbours in any features: each match moves over the mesh while that brings it nearer (ours).

    P, Q        : (point, feature) · (vertex, feature)
    match       : (point,) the vertex at which each search starts
    start, ring : neighbours of the vertices, see `edge_rings`
    returns     : (point,) the vertex at which it ends
    """
    out = np.empty_like(match)
    for i in range(len(match)):
        here, nearer, best = match[i], match[i], np.inf
        for step in range(_STEPS):
            for e in range(start[here] - (step == 0), start[here + 1]):
                u = ring[e] if e >= start[here] else here
                d = 0.0
                for k in range(P.shape[1]):
                    d += (P[i, k] - Q[u, k]) ** 2
                if d < best:
                    nearer, best = u, d
            if nearer == here and step > 0:
                break
            here = nearer
        out[i] = here
    return out


@compiled
def colour_forms(
    r: Floats,
    wanted: Floats,
    G: Floats,
    weight: Floats,
    kappa: float,
    noise: float,
    outlier: float,
    firmest: float,
    chance: float,
) -> tuple[Floats, Floats, Floats]:
    """κ w |G r − e|² of every match as rᵀHr − 2 rᵀp + c, with w smaller where colours disagree.

    r       : (match, xyz) x − y, mesh unit
    wanted  : (match, rgb) e, the body's colour less the frame's
    G       : (match, rgb, xyz) gradient of the frame's colours
    weight  : (match,) that of the match
    kappa   : mesh unit² per colour²
    firmest : most that the trace of κ GᵀG counts
    chance  : |G|² of noise alone, which is taken off
    returns : H (match, 3, 3) · p (match, xyz) · c (match,)
    """
    H, p, c = np.zeros((len(r), 3, 3)), np.zeros((len(r), 3)), np.zeros(len(r))
    for i in range(len(r)):
        square = trace = 0.0
        for k in range(3):
            trace += kappa * (G[i, k, 0] ** 2 + G[i, k, 1] ** 2 + G[i, k, 2] ** 2)
            off = G[i, k, 0] * r[i, 0] + G[i, k, 1] * r[i, 1] + G[i, k, 2] * r[i, 2] - wanted[i, k]
            square += off * off
        w = kappa * weight[i] / (1.0 + square / (3.0 * outlier * outlier * noise * noise)) ** 2
        w *= min(1.0, firmest / max(trace, 1e-30)) * max(0.0, 1.0 - kappa * chance / max(trace, 1e-30))
        for k in range(3):
            c[i] += w * wanted[i, k] ** 2
            for x in range(3):
                p[i, x] += w * G[i, k, x] * wanted[i, k]
                for y in range(3):
                    H[i, x, y] += w * G[i, k, x] * G[i, k, y]
    return H, p, c


@compiled
def _gradient(V: Floats, N: Floats, colour: Floats, start: Ints, ring: Ints) -> Floats:
    """(vertex, channel, xyz), see `surface_gradient`."""
    channels = colour.shape[1]
    out = np.zeros((len(V), channels, 3))
    a, b, d = np.empty(3), np.empty(3), np.empty(3)
    for v in range(len(V)):
        n = N[v]
        small = 0
        for x in range(1, 3):
            if abs(n[x]) < abs(n[small]):
                small = x
        length = 0.0
        for x in range(3):
            a[x] = (1.0 if x == small else 0.0) - n[small] * n[x]
            length += a[x] ** 2
        if length < 1e-12:
            continue
        for x in range(3):
            a[x] /= np.sqrt(length)
        b[0], b[1], b[2] = n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0]
        saa = sab = sbb = 0.0
        for e in range(start[v], start[v + 1]):
            p = q = 0.0
            for x in range(3):
                d[x] = V[ring[e], x] - V[v, x]
                p += d[x] * a[x]
                q += d[x] * b[x]
            saa += p * p
            sab += p * q
            sbb += q * q
        det = saa * sbb - sab * sab
        if det <= 1e-6 * (saa + sbb) ** 2:
            continue
        for k in range(channels):
            ca = cb = 0.0
            for e in range(start[v], start[v + 1]):
                p = q = 0.0
                for x in range(3):
                    d[x] = V[ring[e], x] - V[v, x]
                    p += d[x] * a[x]
                    q += d[x] * b[x]
                change = colour[ring[e], k] - colour[v, k]
                ca += p * change
                cb += q * change
            ga, gb = (sbb * ca - sab * cb) / det, (saa * cb - sab * ca) / det
            for x in range(3):
                out[v, k, x] = ga * a[x] + gb * b[x]
    return out
