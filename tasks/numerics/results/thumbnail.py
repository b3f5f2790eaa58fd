"""A body and its skeleton as a small picture: parallel projection, nearest surface in front, lit from the viewer."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints

Pixels = npt.NDArray[np.uint8]
SIDE = 160
"""Pixels of a side."""
MARGIN = 6
"""Pixels around the body."""
FINER = 1.5
"""Steps of the lattice on a face to a pixel, at least: with one, rounding can leave a pixel out."""
AMBIENT = 0.45
"""Light on a surface that is seen edge on, of that on one seen face on."""
BONE, JOINT = (20, 20, 20), (213, 94, 0)
"""Colours of bones and joints, sRGB."""


def thumbnail(V: Floats, F: npt.NDArray[np.integer], colour: Pixels, joints: Floats, parents: Ints, up: int) -> Pixels:
    """The picture of a mesh with its skeleton in front of it (ours).

    V       : (vertex, xyz) mesh unit
    F       : (face, corner)
    colour  : (vertex, rgb) sRGB, 0 to 255
    joints  : (joint, xyz) mesh unit
    parents : (joint,) parent of each, −1 for the root
    up      : 0, 1, 2 for x, y, z upward, ~0, ~1, ~2 for the opposite directions
    returns : (pixel_row, pixel_column, rgb) sRGB on white; the widest horizontal direction lies along the rows
    """
    axes = _view(V, up)
    projected, bones = V @ axes.T, joints @ axes.T
    both = np.concatenate([projected, bones])[:, :2]
    low, high = both.min(axis=0), both.max(axis=0)
    scale = (SIDE - 2 * MARGIN - 1) / max(float((high - low).max()), 1e-300)
    to_pixels = np.array([scale, -scale, scale])
    middle = np.append((SIDE - 1) / 2 - (low + high) / 2 * to_pixels[:2], 0.0)
    projected, bones = projected * to_pixels + middle, bones * to_pixels + middle  # column, row, nearness in pixels
    points, hue = _surface_points(projected, F, colour.astype(np.float64))
    image = np.full((SIDE, SIDE, 3), 255, np.uint8)
    at, order = _pixels(points), np.argsort(points[:, 2], kind="stable")  # the nearest last, which stays
    image[at[order, 0], at[order, 1]] = hue[order]
    _draw_skeleton(image, _pixels(bones), np.asarray(parents))
    return image


def _pixels(X: Floats) -> Ints:
    """(point, row and column) of positions in pixels."""
    return np.clip(np.rint(X[:, 1::-1]).astype(np.int64), 0, SIDE - 1)


def _view(V: Floats, up: int) -> Floats:
    """(axis, xyz) rightward, upward and towards the viewer; rightward is the widest horizontal direction."""
    vertical = np.zeros(3)
    vertical[up if up >= 0 else ~up] = 1.0 if up >= 0 else -1.0
    flat = V - V.mean(axis=0)
    flat = flat - np.outer(flat @ vertical, vertical)
    widest = np.linalg.eigh(flat.T @ flat)[1][:, -1]
    widest = widest - (widest @ vertical) * vertical
    norm = float(np.linalg.norm(widest))
    right = widest / norm if norm > 1e-9 else np.roll(vertical, 1)
    right = right * (1.0 if right[np.argmax(np.abs(right))] > 0 else -1.0)
    return np.stack([right, vertical, np.cross(right, vertical)])


def _surface_points(X: Floats, F: npt.NDArray[np.integer], colour: Floats) -> tuple[Floats, Pixels]:
    """A lattice on every face, finer than a pixel: (point, xyz) in pixels and lit colours (point, rgb)."""
    corners, hues = X[F], colour[F]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    steepness = np.abs(normal[:, 2]) / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    light = (AMBIENT + (1 - AMBIENT) * steepness)[:, None]
    fineness = 2 ** np.ceil(np.log2(np.maximum(edges * FINER, 1.0))).astype(np.int64)
    points, lit = [X], [colour]
    for n in np.unique(fineness):
        here = fineness == n
        i, j = (k.ravel() for k in np.mgrid[: n + 1, : n + 1])
        share = np.stack([i, j, n - i - j], axis=1)[i + j <= n] / n
        points.append(np.einsum("lc,fcx->flx", share, corners[here]).reshape(-1, 3))
        nearest = np.argmax(share, axis=1)
        lit.append((hues[here][:, nearest] * light[here][:, None]).reshape(-1, 3))
    return np.concatenate(points[1:] or points), np.concatenate(lit[1:] or lit).astype(np.uint8)


def _draw_skeleton(image: Pixels, at: Ints, parents: Ints) -> None:
    """Bones as lines of two pixels, joints as squares of four on them."""
    for joint, parent in enumerate(parents):
        if parent >= 0:
            steps = int(np.abs(at[joint] - at[parent]).max()) + 1
            _dab(image, np.rint(np.linspace(at[parent], at[joint], steps)).astype(np.int64), 2, BONE)
    _dab(image, at, 4, JOINT)


def _dab(image: Pixels, at: Ints, width: int, colour: tuple[int, int, int]) -> None:
    for row in range(-(width // 2), width - width // 2):
        for column in range(-(width // 2), width - width // 2):
            image[np.clip(at[:, 0] + row, 0, SIDE - 1), np.clip(at[:, 1] + column, 0, SIDE - 1)] = colour
