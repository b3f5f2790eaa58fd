"""Pinhole cameras around a subject and the silhouettes they see."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetree.errors import FigureError
from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled


@dataclass(frozen=True)
class Cameras:
    """Projection matrices of several cameras with images of one size.

    P    : (camera, 3, 4), (column·w, row·w, w) = P (x, y, z, 1); pixel centres at whole numbers, w > 0 in front
    size : (rows, columns)
    """

    P: Floats
    size: tuple[int, int]

    def project(self, X: Floats) -> Floats:
        """(camera, point, [column, row]) images of points (point, xyz)."""
        homogeneous = np.einsum("cij,pj->cpi", self.P[:, :, :3], X) + self.P[:, None, :, 3]
        return np.asarray(homogeneous[..., :2] / homogeneous[..., 2:], dtype=np.float64)


def camera_ring(
    count: int, centre: Floats, radius: float, size: tuple[int, int], elevation: float = 15.0, up: int = 2
) -> Cameras:
    """Cameras at even angles around an axis, all looking at `centre` and seeing the whole ball of `radius` about it.

    centre, radius : the ball that holds the subject, its unit
    size           : (rows, columns) in pixels; elevation : degrees above the plane of the ring
    up             : coordinate axis around which the ring runs
    raises         : FigureError without cameras or pixels
    """
    if count < 1 or min(size) < 8:
        raise FigureError(f"{count} cameras of {size[0]} × {size[1]} pixels: expected at least one of at least 8 × 8")
    distance = 4.0 * radius
    focal = 0.48 * min(size) * np.sqrt(distance**2 - radius**2) / radius
    K = np.array([[focal, 0.0, 0.5 * (size[1] - 1)], [0.0, focal, 0.5 * (size[0] - 1)], [0.0, 0.0, 1.0]])
    P = np.empty((count, 3, 4))
    vertical = np.eye(3)[up]
    for c in range(count):
        a, h = 2.0 * np.pi * c / count, np.radians(elevation)
        out = np.cos(h) * (np.cos(a) * np.eye(3)[(up + 1) % 3] + np.sin(a) * np.eye(3)[(up + 2) % 3]) + np.sin(h) * vertical
        right = np.cross(vertical, out)
        right /= np.linalg.norm(right)
        R = np.stack([right, -np.cross(out, right), -out])
        P[c] = K @ np.column_stack([R, -R @ (centre + distance * out)])
    return Cameras(P, size)


def silhouettes(V: Floats, F: Ints, cameras: Cameras) -> Flags:
    """What every camera sees of a mesh: pixels whose centre lies in the image of some face.

    V       : (vertex, xyz) in front of every camera, F : (face, corner)
    returns : (camera, row, column)
    """
    images = cameras.project(V)
    return np.stack([_filled(np.ascontiguousarray(image), F, *cameras.size) for image in images])


@compiled
def _filled(uv, F, rows, columns):  # type: ignore[no-untyped-def]
    """Union of triangles in a raster; a pixel on a shared edge belongs to both."""
    image = np.zeros((rows, columns), dtype=np.bool_)
    for face in F:
        ax, ay = uv[face[0], 0], uv[face[0], 1]
        bx, by = uv[face[1], 0], uv[face[1], 1]
        cx, cy = uv[face[2], 0], uv[face[2], 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area == 0.0:
            continue
        sign = 1.0 if area > 0.0 else -1.0
        for row in range(max(0, int(np.ceil(min(ay, by, cy)))), min(rows - 1, int(np.floor(max(ay, by, cy)))) + 1):
            for column in range(max(0, int(np.ceil(min(ax, bx, cx)))), min(columns - 1, int(np.floor(max(ax, bx, cx)))) + 1):
                a = sign * ((cx - bx) * (row - by) - (cy - by) * (column - bx))
                b = sign * ((ax - cx) * (row - cy) - (ay - cy) * (column - cx))
                c = sign * ((bx - ax) * (row - ay) - (by - ay) * (column - ax))
                if a >= 0.0 and b >= 0.0 and c >= 0.0:
                    image[row, column] = True
    return image
