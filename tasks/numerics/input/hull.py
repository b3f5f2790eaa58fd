"""Visual hull: the largest volume that fills every silhouette (Laurentini 1994), as a signed distance (2009, Sec. 2, step 1).

A point is inside if its image is inside every mask. Instead of this yes or no, every view gives the distance of the image
to the mask's outline, scaled to the depth of the point; the least of all views is the hull's signed distance to first order.
Marching cubes then places the surface between voxels, far better than from occupancy.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from kinetree.errors import HullError
from kinetree.tasks.numerics.arrays import Flags, Floats, Ints, Lengths
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.input.mask_distance import box, cut_sides, mask_distance


class HullSettings(NamedTuple):
    """How the hull is sampled."""

    coarse: int = 64
    """Voxels on the longest side of the box of the views, in which the body is looked for first."""
    band: float = 3.0
    """Voxels from the surface beyond which the distance is cut off; marching cubes needs 1."""
    margin: int = 2
    """Voxels of air around the body, so that its surface is closed."""


@dataclass(frozen=True)
class Field:
    """A signed distance on a grid.

    values  : (x, y, z) positive inside, zero on the surface
    origin  : (xyz,) place of values[0, 0, 0]
    spacing : (xyz,) between neighbours along each axis
    """

    values: Lengths
    origin: Floats
    spacing: Floats


def hull(
    masks: Sequence[Flags], P: Floats, resolution: int, smoothing: float = 1.0, names: Sequence[str] = (),
    settings: HullSettings | None = None,
) -> Field:  # fmt: skip
    """Signed distance of the visual hull.

    masks      : of every camera, (row, column), True on the body, none empty
    P          : (camera, 3, 4), (column·w, row·w, w) = P (x, y, z, 1); pixel centres at whole numbers, w > 0 in front
    resolution : voxels on the longest side of the body
    smoothing  : standard deviation in pixels of the Gaussian over the distances in the images
    names      : what messages call the cameras; their numbers by default
    returns    : in the unit of the cameras, cut off `band` voxels from the surface
    raises     : HullError if no point is inside all masks, or the views do not bound the body
    """
    settings = settings or HullSettings()
    P = P / np.linalg.norm(P[:, 2, :3], axis=1)[:, None, None]
    names = names or [str(c) for c in range(len(P))]
    low, high = view_box(masks, P, names)
    coarse = float((high - low).max()) / settings.coarse
    reach = settings.band * max(coarse, float((high - low).max()) / resolution)
    views = _Views.of(masks, P, 0.5 * (low + high), reach, smoothing)
    sampled = views.sampled(low, high, coarse, coarse)
    near = np.argwhere(sampled.values > -0.9 * coarse)  # half a voxel's diagonal
    if not len(near):
        raise HullError(_disagreement(views, sampled, names))
    low, high = sampled.origin + (near.min(axis=0) - 1) * coarse, sampled.origin + (near.max(axis=0) + 1) * coarse
    spacing = float((high - low).max()) / resolution
    air = settings.margin * spacing
    field = views.sampled(low - air, high + air, spacing, settings.band * spacing)
    if not (field.values > 0.0).any():
        raise HullError(_disagreement(views, sampled, names))
    return field


def view_box(masks: Sequence[Flags], P: Floats, names: Sequence[str]) -> tuple[Floats, Floats]:
    """Lowest and highest corner of the box about all points in front of every camera and inside every mask's rectangle.

    A rectangle's side on the border of the image bounds nothing, for the body may go on beyond it.

    raises : HullError if there is no such point, or the views leave a direction open
    """
    A, b, camera = _half_spaces(masks, P)
    corners = np.empty((2, 3))
    for axis in range(3):
        for end, sign in enumerate((1.0, -1.0)):
            cost = np.zeros(3)
            cost[axis] = sign
            solved = linprog(cost, A_ub=A, b_ub=b, bounds=(None, None))
            if solved.status == 2:
                raise HullError(_empty(A, b, camera, masks, P, names))
            if solved.status != 0:
                raise HullError(
                    f"the {len(P)} views leave the body open to one side: every silhouette that would bound it is cut by the "
                    "border of its image, or the cameras all look along one line; add a view that sees the whole body"
                )
            corners[end, axis] = sign * solved.fun
    return corners[0], corners[1]


def _half_spaces(masks: Sequence[Flags], P: Floats) -> tuple[Floats, Floats, Ints]:
    """A x ≤ b of the points in front of the cameras and inside the masks' rectangles, and the camera of each row."""
    rows, camera = [], []
    for c, (mask, M) in enumerate(zip(masks, P, strict=True)):
        left, top, right, bottom = box(mask)
        cut = cut_sides(mask)
        planes = [M[0] - (left - 0.5) * M[2], M[1] - (top - 0.5) * M[2]]
        planes += [(right + 0.5) * M[2] - M[0], (bottom + 0.5) * M[2] - M[1]]
        uncut = [M[2], *(plane for plane, side in zip(planes, cut, strict=True) if not side)]
        rows += [plane / np.linalg.norm(plane[:3]) for plane in uncut]
        camera += [c] * len(uncut)
    stacked = np.array(rows)
    return -stacked[:, :3], stacked[:, 3], np.array(camera)


def _empty(A: Floats, b: Floats, camera: Ints, masks: Sequence[Flags], P: Floats, names: Sequence[str]) -> str:
    """Which cameras do not fit the others: the least trespass that gives all rectangles one point falls on few of them."""
    count = len(P)
    slack = np.zeros((len(A), count))
    slack[np.arange(len(A)), camera] = -1.0
    solved = linprog(
        np.r_[np.zeros(3), np.ones(count)], A_ub=np.hstack([A, slack]), b_ub=b, bounds=[(None, None)] * 3 + [(0, None)] * count
    )
    at, trespass = solved.x[:3], solved.x[3:]
    wrong = [c for c in range(count) if trespass[c] > 1e-6 * max(1.0, float(trespass.max()))]
    behind = [names[c] for c in wrong if P[c, 2, :3] @ at + P[c, 2, 3] <= 0]
    if behind:
        return (
            f"the body is behind camera {', '.join(behind)}: the third row of its projection matrix must be positive in front "
            "of the camera; change its sign if the matrix was written with the opposite one, or check rotation and translation"
        )
    return (
        f"the rectangles of the {count} silhouettes have no common point; nearest to one is the picture without camera "
        f"{', '.join(names[c] for c in wrong)}: check its calibration, its image size, and that all masks show the same moment"
    )


@dataclass(frozen=True)
class _Views:
    """All masks' distances in one array, with what is needed to look a point up.

    P      : (camera, 3, 4) third row of unit length
    focal  : (camera,) pixels
    values : distances of all masks one after the other
    layout : (camera, [begin, rows, columns, first column, first row, cut left, top, right, bottom])
    """

    P: Floats
    focal: Floats
    values: Lengths
    layout: Ints

    @classmethod
    def of(cls, masks: Sequence[Flags], P: Floats, centre: Floats, reach: float, smoothing: float) -> "_Views":
        """The views of P, distances reaching `reach` in the unit of the cameras about `centre`."""
        across = np.cross(P[:, 0, :3], P[:, 2, :3]), np.cross(P[:, 1, :3], P[:, 2, :3])
        focal = np.sqrt(np.linalg.norm(across[0], axis=1) * np.linalg.norm(across[1], axis=1))
        depth = P[:, 2, :3] @ centre + P[:, 2, 3]
        pixels = np.ceil(reach * focal / np.maximum(depth, 1e-12) + 4.0 * smoothing + 1.0).astype(int)
        longest = [max(mask.shape) for mask in masks]
        maps = [mask_distance(m, int(min(n, most)), smoothing) for m, n, most in zip(masks, pixels, longest, strict=True)]
        sizes = [m.values.size for m in maps]
        begins = np.r_[0, np.cumsum(sizes)[:-1]]
        layout = np.array([[k, *m.values.shape, *m.corner, *m.cut] for k, m in zip(begins, maps, strict=True)], dtype=np.int64)
        return cls(np.ascontiguousarray(P), focal, np.concatenate([m.values.ravel() for m in maps]), layout)

    def sampled(self, low: Floats, high: Floats, spacing: float, band: float) -> Field:
        """The hull's distance on a grid from corner to corner, cut off at `band`."""
        nx, ny, nz = (int(n) for n in np.ceil((high - low) / spacing - 1e-9) + 1)
        values = _least_distance((nx, ny, nz), low, spacing, band, self.P, self.focal, self.values, self.layout)
        return Field(values, low, np.full(3, spacing))


def _disagreement(views: _Views, sampled: Field, names: Sequence[str]) -> str:
    """Which cameras keep the point that most silhouettes hold out of the hull."""
    spacing = float(sampled.spacing[0])
    votes = np.zeros(sampled.values.shape, dtype=np.int32)
    inside_silhouette = []
    for c in range(len(names)):
        one = _Views(views.P[c : c + 1], views.focal[c : c + 1], views.values, views.layout[c : c + 1])
        upper = sampled.origin + (np.array(votes.shape) - 1) * spacing
        inside_silhouette.append(one.sampled(sampled.origin, upper, spacing, spacing).values > -0.9 * spacing)
        votes += inside_silhouette[-1]
    at = np.unravel_index(int(votes.argmax()), votes.shape)
    others = ", ".join(name for name, inside in zip(names, inside_silhouette, strict=True) if not inside[at])
    return (
        f"no point is inside all {len(names)} silhouettes; at most {votes.max()} of them share one, without camera {others}: "
        "check its calibration and its masks, and that all masks show the same moment"
        if others
        else f"the hull of the {len(names)} silhouettes is thinner than a voxel everywhere; raise hull.resolution"
    )


@compiled
def _least_distance(shape, low, spacing, band, P, focal, maps, layout):  # type: ignore[no-untyped-def]
    """Least distance over all views at every grid point; a view that puts it below −band ends the search."""
    values = np.empty(shape, np.float32)
    for i in range(shape[0]):
        x = low[0] + i * spacing
        for j in range(shape[1]):
            y = low[1] + j * spacing
            for k in range(shape[2]):
                z = low[2] + k * spacing
                least = band
                for c in range(len(P)):
                    M = P[c]
                    w = M[2, 0] * x + M[2, 1] * y + M[2, 2] * z + M[2, 3]
                    if w <= 0.0:
                        least = -band
                        break
                    u = (M[0, 0] * x + M[0, 1] * y + M[0, 2] * z + M[0, 3]) / w
                    v = (M[1, 0] * x + M[1, 1] * y + M[1, 2] * z + M[1, 3]) / w
                    least = min(least, _looked_up(u, v, maps, layout[c], -band * focal[c] / w) * w / focal[c])
                    if least <= -band:
                        least = -band
                        break
                values[i, j, k] = least
    return values


@compiled
def _looked_up(u, v, maps, layout, outside):  # type: ignore[no-untyped-def]
    """Distance at (column, row) between pixel centres; beyond an uncut side `outside`, beyond a cut one that of the border."""
    rows, columns = layout[1], layout[2]
    a, b = u - layout[3], v - layout[4]
    if (a < 0.0 and not layout[5]) or (b < 0.0 and not layout[6]):
        return outside
    if (a > columns - 1 and not layout[7]) or (b > rows - 1 and not layout[8]):
        return outside
    a, b = min(max(a, 0.0), columns - 1.0), min(max(b, 0.0), rows - 1.0)
    i, j = min(int(b), max(rows - 2, 0)), min(int(a), max(columns - 2, 0))
    s, t = b - i, a - j
    right, down = min(1, columns - 1), min(1, rows - 1) * columns
    at = layout[0] + i * columns + j
    upper = (1.0 - t) * maps[at] + t * maps[at + right]
    lower = (1.0 - t) * maps[at + down] + t * maps[at + down + right]
    return (1.0 - s) * upper + s * lower
