"""Implicit figures: generalized cylinders blended along their tree, evaluated on a sparse grid near their surface.

A limb is the set |e| < r(t), where e leads from the nearest point of its axis and r is a smooth radius profile.
Limbs that meet at a joint blend by a polynomial smooth minimum whose width shrinks where their gradients agree
(gradient-based blending, after Gourmel et al. 2013), so that a straight limb gets no bulge and a bent one no crease.
All other limbs meet by the plain minimum: they merge when they touch and not before.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled

_BLOCK = 4
"""Grid points along the side of a block; a bound at its centre decides whether any of them is near the surface."""
_SAFE = 1.0 + 1e-9
"""A limb is passed over only if its bound exceeds the least distance by more than rounding."""


class Cones(NamedTuple):
    """Limbs at one pose, as the compiled kernels read them.

    A, D    : (limb, xyz) start and vector to the end; side : (limb, xyz) unit direction in which it is flat
    table   : (limb, knot) radius at even steps; flat : (limb,) share of the radius kept along `side`
    bow     : (limb, xyz) how far the axis is bent sideways in its middle
    folds   : (limb, 3) number of folds around, their depth at the end as a share of the radius, their phase
    cut     : (limb,) whether the limb ends in planes across its axis and not in balls
    first   : (blend + 1,) where each blend's limbs begin in `members`; reach : (blend,) its width
    slope   : Lipschitz bound of every limb's value
    """

    A: Floats
    D: Floats
    side: Floats
    table: Floats
    flat: Floats
    bow: Floats
    folds: Floats
    cut: Flags
    first: Ints
    members: Ints
    reach: Floats
    slope: float


def values(cones: Cones, P: Floats, near: Flags | None = None) -> tuple[Floats, Floats]:
    """Field and its approximate unit gradient at points: negative inside, about the distance near the surface.

    P       : (point, xyz)
    near    : (point, limb) limbs that exist for each point; all of them when None
    returns : (point,) in the figure's unit, (point, xyz)
    """
    if near is None:
        near = np.ones((1, len(cones.A)), dtype=np.bool_)
    return _values(cones, np.ascontiguousarray(P), near)


def limb_distances(cones: Cones, P: Floats) -> Floats:
    """How far every limb is from points: its own value plus half of how far the point lies past the ends of its axis.

    Past a joint the balls of both limbs are equally near; the second term gives the point to the limb beside it.

    P       : (point, xyz)
    returns : (point, limb) in the figure's unit
    """
    return _limb_distances(cones, np.ascontiguousarray(P))


def nearest_limbs(cones: Cones, P: Floats) -> Ints:
    """(point,) the limb to which each point is nearest by `limb_distances`, of equals the first; far limbs are not measured.

    P : (point, xyz)
    """
    return _nearest_limbs(cones, np.ascontiguousarray(P))


def grid_values(cones: Cones, origin: Floats, spacing: float, shape: tuple[int, int, int], band: float) -> Floats:
    """Field on a grid, exact where its magnitude is below `band` and clipped to ±band elsewhere.

    origin  : (xyz) of grid point (0, 0, 0); spacing : between neighbours, the figure's unit
    returns : shape, in the figure's unit
    """
    return _grid_values(cones, np.asarray(origin, dtype=np.float64), float(spacing), shape, float(band))


def extent(cones: Cones) -> tuple[Floats, Floats]:
    """Corners (xyz), (xyz) of the box that holds every limb that is present."""
    r = cones.table.max(axis=1)
    present = r > 0.0
    ends = np.stack([cones.A[present], cones.A[present] + cones.D[present]])
    grow = (r[present] + np.linalg.norm(cones.bow[present], axis=1) + 0.25 * cones.reach.max(initial=0.0))[:, None]
    return (ends - grow).min(axis=(0, 1)), (ends + grow).max(axis=(0, 1))


@compiled
def _limb(cones, b, x, y, z, of_limb):  # type: ignore[no-untyped-def]
    """Value of limb b and its unit gradient into seen[b]."""
    ax, ay, az = cones.D[b, 0], cones.D[b, 1], cones.D[b, 2]
    sx, sy, sz = cones.side[b, 0], cones.side[b, 1], cones.side[b, 2]
    x, y, z = x - cones.A[b, 0], y - cones.A[b, 1], z - cones.A[b, 2]
    at = (x * ax + y * ay + z * az) / (ax * ax + ay * ay + az * az)
    t = min(max(at, 0.0), 1.0)
    x, y, z = x - t * ax, y - t * ay, z - t * az
    bent = 4.0 * t * (1.0 - t)
    x, y, z = x - bent * cones.bow[b, 0], y - bent * cones.bow[b, 1], z - bent * cones.bow[b, 2]
    squeeze = 1.0 / cones.flat[b] - 1.0
    along = squeeze * (x * sx + y * sy + z * sz)
    x, y, z = x + along * sx, y + along * sy, z + along * sz
    length = np.sqrt(x * x + y * y + z * z) + 1e-300
    s = t * (cones.table.shape[1] - 1)
    i = min(int(s), cones.table.shape[1] - 2)
    r = cones.table[b, i] + (s - i) * (cones.table[b, i + 1] - cones.table[b, i])
    if cones.folds[b, 1] > 0.0:
        across = np.sqrt(ax * ax + ay * ay + az * az)
        vx, vy, vz = (ay * sz - az * sy) / across, (az * sx - ax * sz) / across, (ax * sy - ay * sx) / across
        turn = np.arctan2(x * vx + y * vy + z * vz, x * sx + y * sy + z * sz)
        r *= 1.0 + cones.folds[b, 1] * t * np.cos(cones.folds[b, 0] * turn + cones.folds[b, 2])
    of_limb[b, 0] = (length - r) * cones.flat[b]
    if squeeze > 0.0:
        along = squeeze * (x * sx + y * sy + z * sz)
        x, y, z = x + along * sx, y + along * sy, z + along * sz
        length = np.sqrt(x * x + y * y + z * z) + 1e-300
    of_limb[b, 1], of_limb[b, 2], of_limb[b, 3] = x / length, y / length, z / length
    if cones.cut[b]:
        length = np.sqrt(ax * ax + ay * ay + az * az)
        beyond = max(-at, at - 1.0) * length
        if beyond > of_limb[b, 0]:
            length = length if at > 0.5 else -length
            of_limb[b, 0], of_limb[b, 1], of_limb[b, 2], of_limb[b, 3] = beyond, ax / length, ay / length, az / length


@compiled
def _field(cones, near, x, y, z, of_limb, out):  # type: ignore[no-untyped-def]
    """Value and gradient of the blended union of the limbs marked in `near` into out."""
    out[0] = np.inf
    for b in range(len(near)):
        if near[b]:
            _limb(cones, b, x, y, z, of_limb)
            if of_limb[b, 0] < out[0]:
                out[:] = of_limb[b]
    for g in range(len(cones.reach)):
        count = 0
        d, gx, gy, gz = 0.0, 0.0, 0.0, 0.0
        for m in range(cones.first[g], cones.first[g + 1]):
            b = cones.members[m]
            if not near[b]:
                continue
            count += 1
            e, hx, hy, hz = of_limb[b, 0], of_limb[b, 1], of_limb[b, 2], of_limb[b, 3]
            if count == 1:
                d, gx, gy, gz = e, hx, hy, hz
                continue
            width = 0.5 * cones.reach[g] * (1.0 - (gx * hx + gy * hy + gz * hz)) + 1e-12
            h = max(width - abs(d - e), 0.0) / width
            w = 1.0 - 0.5 * h if d < e else 0.5 * h
            d = min(d, e) - 0.25 * h * h * width
            gx, gy, gz = w * gx + (1.0 - w) * hx, w * gy + (1.0 - w) * hy, w * gz + (1.0 - w) * hz
            length = np.sqrt(gx * gx + gy * gy + gz * gz) + 1e-300
            gx, gy, gz = gx / length, gy / length, gz / length
        if count > 1 and d < out[0]:
            out[0], out[1], out[2], out[3] = d, gx, gy, gz


@compiled
def _values(cones, P, near):  # type: ignore[no-untyped-def]
    f, g = np.empty(len(P)), np.empty((len(P), 3))
    of_limb, out = np.empty((len(cones.A), 4)), np.empty(4)
    for i in range(len(P)):
        _field(cones, near[min(i, len(near) - 1)], P[i, 0], P[i, 1], P[i, 2], of_limb, out)
        f[i] = out[0]
        g[i] = out[1:]
    return f, g


@compiled
def _limb_distances(cones, P):  # type: ignore[no-untyped-def]
    d, of_limb = np.empty((len(P), len(cones.A))), np.empty((len(cones.A), 4))
    for i in range(len(P)):
        for b in range(len(cones.A)):
            d[i, b] = _limb_distance(cones, b, P[i, 0], P[i, 1], P[i, 2], of_limb)
    return d


@compiled
def _limb_distance(cones, b, x, y, z, of_limb):  # type: ignore[no-untyped-def]
    """Value of limb b plus half of how far the point lies past the ends of its axis."""
    _limb(cones, b, x, y, z, of_limb)
    dx, dy, dz = cones.D[b, 0], cones.D[b, 1], cones.D[b, 2]
    length = np.sqrt(dx * dx + dy * dy + dz * dz)
    along = ((x - cones.A[b, 0]) * dx + (y - cones.A[b, 1]) * dy + (z - cones.A[b, 2]) * dz) / length
    return of_limb[b, 0] + 0.5 * max(0.0, -along, along - length)


@compiled
def _nearest_limbs(cones, P):  # type: ignore[no-untyped-def]
    """A limb's value is at least the distance to its axis less what it bows and its largest radius, times its flatness."""
    nearest, of_limb, thickness = np.empty(len(P), np.int64), np.empty((len(cones.A), 4)), np.empty(len(cones.A))
    for b in range(len(cones.A)):
        thickness[b] = np.sqrt((cones.bow[b] ** 2).sum()) + max(cones.table[b].max(), 0.0) * (1.0 + max(cones.folds[b, 1], 0.0))
    nearest_limb = 0
    for i in range(len(P)):
        least = _limb_distance(cones, nearest_limb, P[i, 0], P[i, 1], P[i, 2], of_limb)
        for b in range(len(cones.A)):
            dx, dy, dz = cones.D[b, 0], cones.D[b, 1], cones.D[b, 2]
            x, y, z = P[i, 0] - cones.A[b, 0], P[i, 1] - cones.A[b, 1], P[i, 2] - cones.A[b, 2]
            t = min(max((x * dx + y * dy + z * dz) / (dx * dx + dy * dy + dz * dz), 0.0), 1.0)
            away = np.sqrt((x - t * dx) ** 2 + (y - t * dy) ** 2 + (z - t * dz) ** 2) - thickness[b]
            if away > 0.0 and away * min(cones.flat[b], 1.0) > least * _SAFE:
                continue
            d = _limb_distance(cones, b, P[i, 0], P[i, 1], P[i, 2], of_limb)
            if d < least or (d == least and b < nearest_limb):
                least, nearest_limb = d, b
        nearest[i] = nearest_limb
    return nearest


@compiled
def _grid_values(cones, origin, spacing, shape, band):  # type: ignore[no-untyped-def]
    """Blocks whose centre proves them far from the surface are filled with ±band; the others see only near limbs."""
    field = np.empty(shape)
    near = np.ones(len(cones.A), dtype=np.bool_)
    of_limb, out = np.empty((len(cones.A), 4)), np.empty(4)
    half = 0.5 * (_BLOCK - 1) * spacing
    sweep = cones.slope * half * np.sqrt(3.0)
    width = cones.reach.max() if len(cones.reach) else 0.0
    for i0 in range(0, shape[0], _BLOCK):
        i1 = min(i0 + _BLOCK, shape[0])
        for j0 in range(0, shape[1], _BLOCK):
            j1 = min(j0 + _BLOCK, shape[1])
            for k0 in range(0, shape[2], _BLOCK):
                k1 = min(k0 + _BLOCK, shape[2])
                x, y, z = (
                    origin[0] + i0 * spacing + half,
                    origin[1] + j0 * spacing + half,
                    origin[2] + k0 * spacing + half,
                )
                least = np.inf
                for b in range(len(near)):
                    _limb(cones, b, x, y, z, of_limb)
                    least = min(least, of_limb[b, 0])
                if least > sweep + 0.25 * width + band:
                    field[i0:i1, j0:j1, k0:k1] = band
                    continue
                if least < -sweep - band:
                    field[i0:i1, j0:j1, k0:k1] = -band
                    continue
                for b in range(len(near)):
                    near[b] = of_limb[b, 0] <= least + 2.0 * sweep + width
                for i in range(i0, i1):
                    for j in range(j0, j1):
                        for k in range(k0, k1):
                            x, y, z = origin[0] + i * spacing, origin[1] + j * spacing, origin[2] + k * spacing
                            _field(cones, near, x, y, z, of_limb, out)
                            field[i, j, k] = min(max(out[0], -band), band)
    return field
