"""Signed distance to the outline of a mask, in pixels, in a band about it: what places a surface between voxels.

A mask says inside or outside at pixel centres; its outline runs halfway between two centres that differ. The distance to
the nearest centre of the other kind, less half a pixel, is therefore zero on the outline, and a little smoothing takes off
the steps of the raster.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter

from kinetree.tasks.numerics.arrays import Flags, Lengths
from kinetree.tasks.numerics.compiled import compiled

SIDES = ("left", "top", "right", "bottom")


@dataclass(frozen=True)
class MaskDistance:
    """Signed distance of one mask, cropped to where it is not −reach.

    values : (row, column) pixels, positive inside, −reach to reach
    corner : column and row of values[0, 0] in the image
    reach  : pixels
    cut    : (left, top, right, bottom) where the mask touches the border of the image: nothing is known beyond it, and the
             last pixel goes for all that follow
    """

    values: Lengths
    corner: tuple[int, int]
    reach: int
    cut: tuple[bool, bool, bool, bool]


def box(mask: Flags) -> tuple[int, int, int, int]:
    """First column, first row, last column and last row of a mask that is not empty."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return int(columns[0]), int(rows[0]), int(columns[-1]), int(rows[-1])


def cut_sides(mask: Flags) -> tuple[bool, bool, bool, bool]:
    """Whether the mask reaches the (left, top, right, bottom) border of its image."""
    left, top, right, bottom = box(mask)
    return left == 0, top == 0, right == mask.shape[1] - 1, bottom == mask.shape[0] - 1


def mask_distance(mask: Flags, reach: int, smoothing: float) -> MaskDistance:
    """Signed distance to the outline of a mask that is not empty.

    mask      : (row, column) True on the body
    reach     : pixels beyond which the distance is cut off
    smoothing : standard deviation in pixels of the Gaussian that takes off the steps of the raster; 0 for none
    """
    left, top, right, bottom = box(mask)
    cut = cut_sides(mask)
    pad = [0 if side else reach + 1 for side in cut]
    cropped = np.pad(mask[top : bottom + 1, left : right + 1], ((pad[1], pad[3]), (pad[0], pad[2])))
    values = _signed(np.ascontiguousarray(cropped), reach)
    if smoothing > 0.0:
        values = gaussian_filter(values, smoothing, mode="nearest")
    return MaskDistance(values, (left - pad[0], top - pad[1]), reach, cut)


@compiled
def _signed(mask: Flags, reach: int) -> Lengths:
    """Distance to the nearest centre of the other kind less a half, negative outside, cut off at `reach`."""
    rows, columns = mask.shape
    far = reach + 1
    along = np.full((rows, columns), far, np.int32)  # to the nearest of the other kind in the same column
    for c in range(columns):
        steps = far
        for r in range(1, rows):
            steps = 1 if mask[r, c] != mask[r - 1, c] else min(steps + 1, far)
            along[r, c] = steps
        steps = far
        for r in range(rows - 2, -1, -1):
            steps = 1 if mask[r, c] != mask[r + 1, c] else min(steps + 1, far)
            along[r, c] = min(along[r, c], steps)
    values = np.empty((rows, columns), np.float32)
    for r in range(rows):
        for c in range(columns):
            inside, nearest, k = mask[r, c], along[r, c] * along[r, c], 1
            while k * k < nearest:
                for other in (c - k, c + k):
                    if 0 <= other < columns:
                        step = 0 if mask[r, other] != inside else along[r, other]
                        nearest = min(nearest, k * k + step * step)
                k += 1
            distance = min(np.sqrt(np.float64(nearest)) - 0.5, np.float64(reach))
            values[r, c] = distance if inside else -distance
    return values
