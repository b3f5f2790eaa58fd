"""How one property of one node of a glTF moves.

Source: Khronos Group, glTF 2.0 Specification, Sec. 3.11 (animations), appendix C (interpolation).
"""

from dataclasses import dataclass

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


@dataclass(frozen=True)
class Channel:
    """How one property of one node moves.

    values : (key, width); (key, 3, width) with tangents before and after for cubic splines
    """

    node: int
    path: str
    times: Floats
    values: Floats
    way: str

    def at(self, t: float) -> Floats:
        """The value at a time; before the first key it is the first, after the last the last."""
        k = int(np.clip(np.searchsorted(self.times, t, "right") - 1, 0, len(self.times) - 1))
        middle = self.values[:, 1] if self.way == "CUBICSPLINE" else self.values
        if k == len(self.times) - 1 or t <= self.times[0] or self.way == "STEP":
            return middle[k]
        step = self.times[k + 1] - self.times[k]
        s = float((t - self.times[k]) / step)
        if self.way == "CUBICSPLINE":
            a, b = self.values[k], self.values[k + 1]
            value = (2 * s**3 - 3 * s**2 + 1) * a[1] + (s**3 - 2 * s**2 + s) * step * a[2]
            value = value + (3 * s**2 - 2 * s**3) * b[1] + (s**3 - s**2) * step * b[0]
            return value / max(float(np.linalg.norm(value)), 1e-12) if self.path == "rotation" else value
        a, b = middle[k], middle[k + 1]
        return _between(a, b, s) if self.path == "rotation" else (1 - s) * a + s * b


def rotation_matrix(q: Floats) -> Floats:
    """(3, 3) of a quaternion (x, y, z, w)."""
    x, y, z, w = q / max(float(np.linalg.norm(q)), 1e-12)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _between(a: Floats, b: Floats, s: float) -> Floats:
    """The rotation (x, y, z, w) a share s of the way from a to b, the shorter way round (Sec. 3.11, appendix C)."""
    cosine = float(a @ b)
    b, cosine = (b, cosine) if cosine >= 0 else (-b, -cosine)
    if cosine > 0.9995:
        value = (1 - s) * a + s * b
        return value / max(float(np.linalg.norm(value)), 1e-12)
    angle = np.arccos(min(cosine, 1.0))
    return (np.sin((1 - s) * angle) * a + np.sin(s * angle) * b) / np.sin(angle)
