"""Surfaces of revolution: a wide trunk, a neck of radius 1 and a head; and others."""

from itertools import pairwise

import numpy as np

BOTTOM, TOP = 6.0, 7.7
"""Heights at which the neck begins and ends."""
AROUND = 48


def bottle(trunk: float, head: float) -> tuple[np.ndarray, np.ndarray]:
    """(vertex, xyz) · (face, corner) of radii trunk, 1 and head, with short slopes between them, closed at both ends."""
    height = [0.0, 0.5, BOTTOM - 0.3, BOTTOM, TOP, TOP + 0.3, TOP + 3.0, TOP + 3.5]
    return revolution(height, [0.3 * trunk, trunk, trunk, 1.0, 1.0, head, head, 0.3 * head])


def revolution(height: list[float], radius: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """(vertex, xyz) · (face, corner) with these radii at these heights, ascending, closed at both ends."""
    z = np.concatenate([np.linspace(a, b, max(int((b - a) / 0.12), 4), endpoint=False) for a, b in pairwise(height)])
    r, angle = np.interp(z, height, radius), np.arange(AROUND) * 2.0 * np.pi / AROUND
    ring = np.stack([r[:, None] * np.cos(angle), r[:, None] * np.sin(angle), np.tile(z[:, None], AROUND)], axis=2)
    V = np.concatenate([ring.reshape(-1, 3), [[0.0, 0.0, z[0]], [0.0, 0.0, z[-1]]]])
    k, nxt = np.arange(AROUND), (np.arange(AROUND) + 1) % AROUND
    F = []
    for i in range(len(z) - 1):
        a, b, c, d = i * AROUND + k, i * AROUND + nxt, (i + 1) * AROUND + k, (i + 1) * AROUND + nxt
        F += [np.stack([a, b, d], axis=1), np.stack([a, d, c], axis=1)]
    last = (len(z) - 1) * AROUND
    F += [np.stack([np.full(AROUND, len(V) - 2), nxt, k], axis=1)]
    F += [np.stack([np.full(AROUND, len(V) - 1), last + k, last + nxt], axis=1)]
    return V, np.concatenate(F).astype(np.int64)
