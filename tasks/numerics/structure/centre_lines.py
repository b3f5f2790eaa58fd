"""Centre lines of long parts, on which their joints are expected: a hip's flesh lies to one side of the thigh (ours)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


class CentreLinesSettings(NamedTuple):
    """Which parts have a centre line, and how much it counts."""

    sections: int = 12
    """Sections across a part. Not recorded."""
    sectors: int = 12
    """Sectors around a section. Not recorded."""
    filled_sectors: int = 10
    """Sectors in which a section must have surface to be whole. Not recorded."""
    whole_sections: int = 6
    """Whole sections that make a line, at least. Not recorded."""
    ends: float = 0.01
    """Share of a part's surface beyond its first and beyond its last section. Not recorded."""
    slender: tuple[float, float] = (1.3, 1.7)
    """Spread of a part along its line by that across it: up to the first it has no line, from the second it counts in full. Not
    recorded."""
    bent: tuple[float, float] = (0.08, 0.16)
    """Distance of the sections' middles from the line, in radii of the border: up to the first it counts in full, from the
    second on not. Chosen on shanks, whose calves lead past the knee at half a radius."""
    astray: tuple[float, float] = (1.2, 1.6)
    """The same for the distance of the line from the border's middle. Thighs' lines pass it at 0.2 to 0.5, those of arms at 0.5
    to 1.3 where flesh of the chest goes with the arm. Chosen on generated humans and random trees of seeds 0 to 9, humans 20 to
    29 and people 0 to 14: of random trees lines lead away that pass it at 1.6 and more."""


class CentreLine(NamedTuple):
    """The straight line nearest to the middles of a part's whole sections.

    point, axis : (xyz) mesh unit, (xyz) of length 1
    slender     : spread of the part along its longest axis by that across it
    bent        : root mean square distance of the middles from the line, mesh unit
    """

    point: Floats
    axis: Floats
    slender: float
    bent: float


class ExpectedJoints(NamedTuple):
    """Where joints are expected, and along which lines.

    place : (joint, xyz) mesh unit
    lines : (joint, 3, 3) Σ w a aᵀ over the lines a that a joint is expected on, w ≤ 1 how much each counts, all together 1 at
            most: across them the place is more certain than along them
    """

    place: Floats
    lines: Floats


def about_lines(lines: Floats, elsewhere: float, across: float, along: float) -> Floats:
    """(joint, 3, 3) a stiffness: `across` and `along` the lines of `ExpectedJoints`, `elsewhere` where no line is.

    Where lines count in part it lies in between.
    """
    count = np.trace(lines, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
    return np.asarray(elsewhere * (np.eye(3) - count) + across * (count - lines) + along * lines)


def towards_centre_lines(
    V: Floats,
    area: Floats,
    label: Ints,
    W: Floats,
    parents: Ints,
    expected: Floats,
    radius: Floats,
    settings: CentreLinesSettings | None = None,
) -> ExpectedJoints:
    """The places where joints are expected, moved onto the centre lines of the long parts that they join (ours).

    Only parts with exactly one part below them have a line: a hand or a foot may lie across its joint, a trunk has no axis.

    V, area  : (vertex, xyz), (vertex,) mesh unit
    label    : (vertex,) part, W : (vertex, part) skinning weights
    parents  : (part,) −1 for the root, parents before children
    expected : (joint, xyz) of every part but the root, radius : (joint,) of its border, mesh unit
    """
    chosen = settings or CentreLinesSettings()
    below = np.bincount(parents[1:], minlength=len(parents))
    lines: dict[int, CentreLine] = {}
    for part in np.flatnonzero(below == 1).tolist():
        own = np.flatnonzero(label == part)
        line = centre_line(V[own], area[own] * W[own, part] ** 2, chosen)
        if line is not None:
            lines[part] = line
    place, axes = expected.copy(), np.zeros((len(expected), 3, 3))
    for joint in range(1, len(parents)):
        at, size = expected[joint - 1], max(float(radius[joint - 1]), np.finfo(float).tiny)
        beside = [lines[part] for part in (int(parents[joint]), joint) if part in lines]
        offsets = [line.point + line.axis * ((at - line.point) @ line.axis) - at for line in beside]
        weight = [_weight(line, float(np.linalg.norm(o)) / size, size, chosen) for line, o in zip(beside, offsets, strict=True)]
        for line, offset, share in zip(beside, offsets, np.array(weight) / max(sum(weight), 1.0), strict=True):
            place[joint - 1] += share * offset
            axes[joint - 1] += share * np.outer(line.axis, line.axis)
    return ExpectedJoints(place, axes)


def centre_line(V: Floats, mass: Floats, settings: CentreLinesSettings | None = None) -> CentreLine | None:
    """The line through the middles of a part's sections, each the centroid of the area inside; open sections do not count.

    A border that cuts the part obliquely, as the groin does a thigh, tilts its principal axis, but no whole section.

    V, mass : (vertex, xyz) mesh unit, (vertex,) how much of the surface each stands for
    returns : None where there are too few whole sections
    """
    chosen = settings or CentreLinesSettings()
    total = float(mass.sum())
    if total <= 0.0:
        return None
    point = mass @ V / total
    variance, axes = np.linalg.eigh((mass[:, None] * (V - point)).T @ (V - point) / total)
    slender = float(np.sqrt(variance[2] / max(float(variance[:2].mean()), np.finfo(float).tiny)))
    axis, bent = axes[:, 2], 0.0
    for _ in range(3):
        middles = _middles(V - point, mass, axis, chosen)
        if len(middles) < chosen.whole_sections:
            return None
        mean = middles.mean(axis=0)
        spread, rows = np.linalg.svd(middles - mean, full_matrices=False)[1:]
        point, axis, bent = point + mean, rows[0], float(np.sqrt((spread[1:] ** 2).sum() / len(middles)))
    return CentreLine(point, axis, slender, bent)


def _middles(V: Floats, mass: Floats, axis: Floats, chosen: CentreLinesSettings) -> Floats:
    """(section, xyz) middles of the whole sections across an axis: twice the centroid of the polygon around the last one."""
    along, sections = V @ axis, chosen.sections
    order = np.argsort(along, kind="stable")
    below = np.cumsum(mass[order]) / mass.sum()
    low, high = along[order[np.searchsorted(below, [chosen.ends, 1.0 - chosen.ends])]]
    section = np.floor(sections * (along - low) / max(high - low, np.finfo(float).tiny)).astype(np.int64)
    kept = (section >= 0) & (section < sections) & (mass > 0.0)
    section, m = section[kept], mass[kept]
    side = np.eye(3)[np.argmin(np.abs(axis))]
    frame = np.stack([np.cross(axis, side), np.cross(axis, np.cross(axis, side))])
    frame /= np.linalg.norm(frame, axis=1, keepdims=True)
    at = V[kept] @ frame.T
    held = np.maximum(np.bincount(section, m, sections), 1e-300)
    middle = np.stack([np.bincount(section, m * at[:, x], sections) for x in (0, 1)], axis=1) / held[:, None]
    height = np.bincount(section, m * along[kept], sections) / held
    whole = np.ones(sections, dtype=bool)
    for _ in range(2):
        moved, filled = _centroids(at - middle[section], m, section, chosen)
        middle, whole = middle + moved, whole & (filled >= chosen.filled_sectors)
    return np.asarray((middle @ frame + height[:, None] * axis)[whole])


def _centroids(at: Floats, mass: Floats, section: Ints, chosen: CentreLinesSettings) -> tuple[Floats, Ints]:
    """(section, 2) centroids of the polygons through the mean points of the sectors around 0, and (section,) sectors filled."""
    sections, sectors = chosen.sections, chosen.sectors
    angle = np.arctan2(at[:, 1], at[:, 0]) + np.pi
    cell = section * sectors + np.minimum((sectors * angle / (2.0 * np.pi)).astype(np.int64), sectors - 1)
    held = np.bincount(cell, mass, sections * sectors).reshape(sections, sectors)
    sums = [np.bincount(cell, mass * at[:, x], sections * sectors).reshape(sections, sectors) for x in (0, 1)]
    corner = np.stack(sums, axis=2) / np.maximum(held, 1e-300)[:, :, None]
    known = held > 0.0
    filled: Ints = known.sum(axis=1)
    for _ in range(sectors - 1):
        corner = np.where(known[:, :, None], corner, np.roll(corner, 1, axis=1))
        known = known | np.roll(known, 1, axis=1)
    after = np.roll(corner, -1, axis=1)
    cross = corner[:, :, 0] * after[:, :, 1] - after[:, :, 0] * corner[:, :, 1]
    six = 3.0 * cross.sum(axis=1)
    moment = ((corner + after) * cross[:, :, None]).sum(axis=1)
    return np.where(six[:, None] > 0.0, moment / np.where(six > 0.0, six, 1.0)[:, None], 0.0), filled


def _weight(line: CentreLine, astray: float, radius: float, chosen: CentreLinesSettings) -> float:
    """0 to 1: how much a line counts for a joint whose border is so far from it, in radii, and so wide, in mesh unit."""
    straight, near = 1.0 - _ramp(line.bent / radius, *chosen.bent), 1.0 - _ramp(astray, *chosen.astray)
    return _ramp(line.slender, *chosen.slender) * straight * near


def _ramp(value: float, low: float, high: float) -> float:
    """0 up to `low`, 1 from `high` on."""
    return float(np.clip((value - low) / (high - low), 0.0, 1.0))
