"""The centre line of a long part says where its joints are: a hip's flesh lies to one side of it, the thigh does not."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints

SECTIONS, SECTORS = 12, 12
CLOSED, LEAST = 10, 6
"""Sectors in which a section must have surface to be whole, and whole sections that make a line."""
ENDS = 0.01
"""Share of a part's surface beyond its first and its last section."""
LONG = (1.3, 1.7)
"""Spread of a part along its line by that across it, from which on it has one, and in full."""
BENT = (0.08, 0.16)
"""Distance of the middles of sections from the line, in radii of the border, from which on it is believed less, and not."""
ASTRAY = (0.7, 1.1)
"""The same for the distance of the line from the border's middle."""


class Line(NamedTuple):
    """The straight line nearest to the middles of a part's whole sections.

    point, axis : (xyz) mesh unit, (xyz) of length 1
    slender     : spread of the part along its longest axis by that across it
    bent        : root mean square distance of the middles from the line, mesh unit
    """

    point: Floats
    axis: Floats
    slender: float
    bent: float


def towards_centre_lines(
    V: Floats, area: Floats, label: Ints, W: Floats, parents: Ints, expected: Floats, radius: Floats
) -> Floats:
    """(joint, xyz) the places where joints are expected, moved onto the lines of the long parts that they join.

    Only parts of limbs have one, on which one other hangs: a hand or a foot may lie across its joint, a trunk has no axis.

    V, area  : (vertex, xyz), (vertex,) mesh unit
    label    : (vertex,) part, W : (vertex, part) skinning weights
    parents  : (part,) −1 for the root, parents before children
    expected : (joint, xyz) of every part but the root, radius : (joint,) of its border, mesh unit
    """
    hang = np.bincount(parents[1:], minlength=len(parents))
    lines: dict[int, Line] = {}
    for part in np.flatnonzero(hang == 1).tolist():
        mine = np.flatnonzero(label == part)
        line = centre_line(V[mine], area[mine] * W[mine, part] ** 2)
        if line is not None:
            lines[part] = line
    out = expected.copy()
    for joint in range(1, len(parents)):
        at, size = expected[joint - 1], max(float(radius[joint - 1]), np.finfo(float).tiny)
        beside = [lines[part] for part in (int(parents[joint]), joint) if part in lines]
        ways = [line.point + line.axis * ((at - line.point) @ line.axis) - at for line in beside]
        belief = [_belief(line, float(np.linalg.norm(way)) / size, size) for line, way in zip(beside, ways, strict=True)]
        for way, share in zip(ways, belief, strict=True):
            out[joint - 1] += share * way / max(sum(belief), 1.0)
    return out


def centre_line(V: Floats, mass: Floats) -> Line | None:
    """The line through the middles of a part's sections, each the centroid of the area inside; open sections say nothing.

    A border that cuts the part obliquely, as the groin does a thigh, tilts its principal axis, but no whole section.

    V, mass : (vertex, xyz) mesh unit, (vertex,) how much of the surface each stands for
    returns : None where there are too few whole sections
    """
    total = float(mass.sum())
    if total <= 0.0:
        return None
    point = mass @ V / total
    variance, axes = np.linalg.eigh((mass[:, None] * (V - point)).T @ (V - point) / total)
    slender = float(np.sqrt(variance[2] / max(float(variance[:2].mean()), np.finfo(float).tiny)))
    axis, bent = axes[:, 2], 0.0
    for _ in range(3):
        middles = _middles(V - point, mass, axis)
        if len(middles) < LEAST:
            return None
        mean = middles.mean(axis=0)
        spread, rows = np.linalg.svd(middles - mean, full_matrices=False)[1:]
        point, axis, bent = point + mean, rows[0], float(np.sqrt((spread[1:] ** 2).sum() / len(middles)))
    return Line(point, axis, slender, bent)


def _middles(V: Floats, mass: Floats, axis: Floats) -> Floats:
    """(section, xyz) middles of the whole sections across an axis: twice the centroid of the polygon around the last one."""
    along = V @ axis
    order = np.argsort(along, kind="stable")
    below = np.cumsum(mass[order]) / mass.sum()
    low, high = along[order[np.searchsorted(below, [ENDS, 1.0 - ENDS])]]
    section = np.floor(SECTIONS * (along - low) / max(high - low, np.finfo(float).tiny)).astype(np.int64)
    kept = (section >= 0) & (section < SECTIONS) & (mass > 0.0)
    section, m = section[kept], mass[kept]
    side = np.eye(3)[np.argmin(np.abs(axis))]
    frame = np.stack([np.cross(axis, side), np.cross(axis, np.cross(axis, side))])
    frame /= np.linalg.norm(frame, axis=1, keepdims=True)
    at = V[kept] @ frame.T
    held = np.maximum(np.bincount(section, m, SECTIONS), 1e-300)
    middle = np.stack([np.bincount(section, m * at[:, x], SECTIONS) for x in (0, 1)], axis=1) / held[:, None]
    height = np.bincount(section, m * along[kept], SECTIONS) / held
    whole = np.ones(SECTIONS, dtype=bool)
    for _ in range(2):
        moved, filled = _centroids(at - middle[section], m, section)
        middle, whole = middle + moved, whole & (filled >= CLOSED)
    return np.asarray((middle @ frame + height[:, None] * axis)[whole])


def _centroids(at: Floats, mass: Floats, section: Ints) -> tuple[Floats, Ints]:
    """(section, 2) centroids of the polygons through the mean points of the sectors around 0, and (section,) sectors filled."""
    angle = np.arctan2(at[:, 1], at[:, 0]) + np.pi
    cell = section * SECTORS + np.minimum((SECTORS * angle / (2.0 * np.pi)).astype(np.int64), SECTORS - 1)
    held = np.bincount(cell, mass, SECTIONS * SECTORS).reshape(SECTIONS, SECTORS)
    sums = [np.bincount(cell, mass * at[:, x], SECTIONS * SECTORS).reshape(SECTIONS, SECTORS) for x in (0, 1)]
    corner = np.stack(sums, axis=2) / np.maximum(held, 1e-300)[:, :, None]
    known = held > 0.0
    filled: Ints = known.sum(axis=1)
    for _ in range(SECTORS - 1):
        corner = np.where(known[:, :, None], corner, np.roll(corner, 1, axis=1))
        known = known | np.roll(known, 1, axis=1)
    after = np.roll(corner, -1, axis=1)
    cross = corner[:, :, 0] * after[:, :, 1] - after[:, :, 0] * corner[:, :, 1]
    six = 3.0 * cross.sum(axis=1)
    moment = ((corner + after) * cross[:, :, None]).sum(axis=1)
    return np.where(six[:, None] > 0.0, moment / np.where(six > 0.0, six, 1.0)[:, None], 0.0), filled


def _belief(line: Line, astray: float, radius: float) -> float:
    """0 to 1: how far a line says where a joint is whose border is so far from it, in radii, and so wide."""
    return _ramp(line.slender, *LONG) * (1.0 - _ramp(line.bent / radius, *BENT)) * (1.0 - _ramp(astray, *ASTRAY))


def _ramp(value: float, low: float, high: float) -> float:
    """0 up to `low`, 1 from `high` on."""
    return float(np.clip((value - low) / (high - low), 0.0, 1.0))
