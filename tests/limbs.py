"""Limbs whose every point's way is known: closed tubes bent at a joint, cut anew for every frame, and a body that twists."""

import numpy as np
import numpy.typing as npt
from skimage.measure import marching_cubes

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
LENGTH = 10.0  # half of it on either side of the joint at the origin
RADIUS = 1.0
ANGLES = (0.0, 0.2, 0.4, 0.6, 0.8)
"""How far the tube is bent in the frames of a sequence, radians."""
REACHING = np.array([[5.0, 4.0, 3.0], [-5.0, 4.0, 3.0], [2.0, 0.0, -9.0], [-2.0, 0.0, -9.0]])
"""(limb, xyz) ends of two arms that reach forwards and of two legs; the trunk is the z axis from −4 to 4."""
ROOTS = np.array([[0.0, 0.0, 3.0], [0.0, 0.0, 3.0], [0.0, 0.0, -4.0], [0.0, 0.0, -4.0]])


def tube(around: int = 24, along: int = 48, start: float = 0.0, flat: float = 0.7) -> tuple[Floats, Ints]:
    """A closed tube along z with round ends and an oval section, V (vertex, xyz) and F (face, corner).

    Other numbers around and along, or another start, give the same surface other vertices and faces.
    """
    arc = np.pi / 2 * RADIUS
    s = np.linspace(0, LENGTH - 2 * RADIUS + 2 * arc, along + 1)[1:-1]
    low, high = s < arc, s > s[-1] + s[0] - arc
    end = np.where(high, s[-1] + s[0] - s, s) / RADIUS
    r = np.where(low | high, RADIUS * np.sin(end), RADIUS)
    z = np.where(low, -LENGTH / 2 + RADIUS * (1 - np.cos(end)), s - arc - LENGTH / 2 + RADIUS)
    z = np.where(high, LENGTH / 2 - RADIUS * (1 - np.cos(end)), z)
    phi = start + 2 * np.pi * np.arange(around) / around
    rings = np.stack([r[:, None] * np.cos(phi), flat * r[:, None] * np.sin(phi), np.repeat(z[:, None], around, axis=1)], axis=2)
    V = np.concatenate([rings.reshape(-1, 3), [[0, 0, -LENGTH / 2], [0, 0, LENGTH / 2]]])
    i, j = (x.ravel() for x in np.meshgrid(np.arange(len(s) - 1), np.arange(around), indexing="ij"))
    k = (j + 1) % around
    a, b, c, d = i * around + j, i * around + k, (i + 1) * around + k, (i + 1) * around + j
    j, k = np.arange(around), (np.arange(around) + 1) % around
    last = (len(s) - 1) * around
    caps = [np.stack([np.full(around, len(V) - 2), k, j], 1), np.stack([np.full(around, len(V) - 1), last + j, last + k], 1)]
    return V, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1), *caps])


def bent(V: Floats, angle: float, blend: float = 1.0) -> Floats:
    """Every point with z > 0 turned about the x axis by `angle`, those within `blend` of the joint by a part of it."""
    share = np.clip((V[:, 2] / blend + 1) / 2, 0, 1)
    turn = angle * share * share * (3 - 2 * share)
    y, z = V[:, 1], V[:, 2]
    return np.stack([V[:, 0], np.cos(turn) * y - np.sin(turn) * z, np.sin(turn) * y + np.cos(turn) * z], axis=1)


def rotation(axis: tuple[float, float, float], angle: float) -> Floats:
    """(3, 3) about an axis through the origin."""
    k = np.asarray(axis) / np.linalg.norm(axis)
    K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def reaching_body() -> tuple[Floats, Ints, Floats]:
    """V, F of a trunk, two arms and two legs, and stems (limb, station, xyz)."""
    x = np.stack(
        np.meshgrid(np.arange(-7, 7.1, 0.4), np.arange(-3, 6.1, 0.4), np.arange(-11, 6.1, 0.4), indexing="ij"), axis=-1
    )
    ends = [
        (np.array([0.0, 0.0, -4.0]), np.array([0.0, 0.0, 4.0]), 1.3),
        *((a, b, 0.8) for a, b in zip(ROOTS, REACHING, strict=True)),
    ]
    along = [np.clip((x - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1) for a, b, _ in ends]
    inside = [r - np.linalg.norm(x - a - s[..., None] * (b - a), axis=-1) for (a, b, r), s in zip(ends, along, strict=True)]
    surface, faces, _, _ = marching_cubes(np.max(inside, axis=0), 0.0, gradient_direction="ascent")
    share = np.linspace(0.2, 1.0, 5)[None, :, None]
    stems = ROOTS[:, None] + share * (REACHING - ROOTS)[:, None]
    return surface * 0.4 + x[0, 0, 0], np.ascontiguousarray(faces, dtype=np.int64), stems


def twisted(x: Floats, angle: float) -> Floats:
    """Points (…, xyz) turned about the trunk, the chest in full and the legs not at all."""
    turn = angle * np.clip((x[..., 2] + 3.0) / 5.0, 0.0, 1.0)
    cos, sin = np.cos(turn), np.sin(turn)
    return np.stack([cos * x[..., 0] - sin * x[..., 1], sin * x[..., 0] + cos * x[..., 1], x[..., 2]], axis=-1)
