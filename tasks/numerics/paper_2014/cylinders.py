"""The undefined area, the cylinders that define it one after another, and the areas of all (2014, Sec. 6.2; Figs. 13, 14)."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.paper_2014.annuli import annulus_clusters, least_rigid, self_errors
from kinetree.tasks.numerics.paper_2014.cones import bands, components, dead_ends, edges, grown, neighbours
from kinetree.tasks.numerics.paper_2014.integration import integrated

Clustering = Callable[[list[Ints]], Flags]
"""From the vertices of each annulus to whether each annulus belongs to a rigid area, all intervals considered."""


class CylindersSettings(NamedTuple):
    """Which part of the undefined area a cylinder may take."""

    least_area: float = 0.005
    """Smallest component of the undefined area that is extended into, share of the area of the body; smaller ones join the
    areas around them. Not recorded what it was chosen on. At 0 fragments between cones become joints of their own."""
    least_annulus: float = 0.5
    """Share of an annulus that must be its cone's alone; chosen as the greater part. Near 0 scraps count as rings, at 1
    a cone ends where the first triangle is shared."""


class Cylinder(NamedTuple):
    """A kinematic cone or a kinematic cylinder.

    cone    : the cone, or the cone that the cylinder extends
    annulus : (vertex,) annulus of every vertex, −1 outside
    rigid   : (annulus,) whether each annulus from 0 to the last is rigid
    """

    cone: int
    annulus: Ints
    rigid: Flags


class IntervalMotion(NamedTuple):
    """One interval's reference in all of its frames.

    x            : (frame, own vertex, xyz) mesh unit
    model_vertex : (own vertex,) the corresponding vertex of the model mesh, −1 for none
    floor        : see `merge_error`, mesh unit
    at_rest      : whether no part of the body moved against another
    """

    x: Floats
    model_vertex: Ints
    floor: float
    at_rest: bool


class Areas(NamedTuple):
    """A partition of the surface into rigid and non-rigid areas.

    label                       : (vertex,) area
    rigid                       : (area,) whether it is rigid; the others are joints
    cylinder                    : (area,) the cone or cylinder that it belongs to
    first_annulus, last_annulus : (area,) its annuli there
    """

    label: Ints
    rigid: Flags
    cylinder: Ints
    first_annulus: Ints
    last_annulus: Ints


def kinematic_cones(annulus: Ints, rigid: Flags, area: Floats, settings: CylindersSettings | None = None) -> list[Cylinder]:
    """Kinematic cones without the farthest overlapping rigid area and all beyond it, and without other overlaps (Sec. 6.2.2).

    A rigid area that overlaps with another cone may be part of either, so all of it is cut off. What cones still share is
    undefined, and so is an annulus that mostly is, with all beyond it (ours): the rest of it is no ring.

    annulus : (cone, vertex) annulus of every vertex, −1 beyond the cone
    rigid   : (cone, annulus) as integrated over the intervals
    area    : (vertex,) mesh unit²
    """
    least = (settings or CylindersSettings()).least_annulus
    overlapping = (annulus >= 0).sum(axis=0) > 1
    cut = np.array([_without_shared_end(own, r, overlapping) for own, r in zip(annulus, rigid, strict=True)])
    cut = cut.reshape(annulus.shape)
    claims = (cut >= 0).sum(axis=0)
    out = []
    for n, own in enumerate(cut):
        alone = np.where(claims == 1, own, -1)
        length = int(own.max(initial=-1)) + 1
        unshared, whole = (np.bincount(k[k >= 0], area[k >= 0], length) for k in (alone, own))
        partial = np.flatnonzero(unshared < least * whole)
        alone[alone >= partial.min(initial=length)] = -1
        out.append(Cylinder(n, alone, rigid[n, : int(alone.max(initial=-1)) + 1]))
    return out


def cylinders(
    cones: list[Cylinder],
    distance: Floats,
    area: Floats,
    F: Ints,
    clustering: Clustering,
    annuli: int,
    settings: CylindersSettings | None = None,
) -> list[Cylinder]:
    """Takes the extension with the widest range of distances, clusters it, cuts it off, until none is left (Sec. 6.2).

    cones      : all kinematic cones
    distance   : (cone, vertex) from the cone's leaf, mesh unit; NaN for a cone whose leaf is not seen in the reference
    area, F    : (vertex,) mesh unit² · (face, corner)
    clustering : finds the rigid annuli of an extension
    annuli     : in the longest distance from a leaf
    returns    : the cylinders, in the order in which they were found
    """
    settings = settings or CylindersSettings()
    E = edges(F)
    band = [bands(d, annuli) for d in distance]
    dead_end = [dead_ends(own, E) for own in band]
    cone_of = np.full(len(area), -1)
    for cone in cones:
        cone_of[cone.annulus >= 0] = cone.cone
    out: list[Cylinder] = []
    while True:
        component = components(cone_of == -1, E)
        small = np.bincount(component[component >= 0], area[component >= 0], len(area)) < settings.least_area * area.sum()
        cone_of[(component >= 0) & small[component]] = -2
        widest = _widest_extension(cone_of, band, dead_end, distance, area, E)
        if widest is None:
            return out
        n, annulus = widest
        used = np.unique(annulus[annulus >= 0])
        annulus = np.where(annulus >= 0, np.searchsorted(used, annulus), -1)
        rigid = clustering([np.flatnonzero(annulus == k) for k in range(len(used))])
        out.append(Cylinder(n, annulus, rigid))
        cone_of[annulus >= 0] = n


def rigid_annuli(
    annuli: list[Ints], intervals: list[IntervalMotion], theta: float, vertices: int, *, at_least_rigid: bool = False
) -> Flags:
    """(annulus,) whether each annulus of an extension is rigid in all intervals (Sec. 6.2.3, as Sec. 6.1.2 and 6.1.3).

    annuli         : of each, its vertices on the model mesh
    intervals      : in any order
    theta          : θ_r, threshold of Eq. 12
    vertices       : of the model mesh
    at_least_rigid : whether joints are moved as `least_rigid` does
    """
    of_model = np.full(vertices, -1)
    for k, inside in enumerate(annuli):
        of_model[inside] = k
    annulus, rigid = [], []
    for x, model_vertex, floor, at_rest in intervals:
        own = np.where(model_vertex >= 0, of_model[model_vertex], -1)
        annulus.append(np.unique(own[own >= 0]))
        moving = [x[:, own == k] for k in annulus[-1]]
        clustered = annulus_clusters(moving, [theta], floor)[0].rigid
        rigid.append((least_rigid(clustered, self_errors(moving)) if at_least_rigid else clustered) | at_rest)
    return integrated(annulus, rigid, len(annuli))


def areas(cylinders: list[Cylinder], vertices: int, F: Ints) -> Areas:
    """Contiguous annuli of a cone or cylinder that are all rigid, or all not, are one area (Sec. 6.1.2.3).

    A vertex in no cone or cylinder belongs to the area that is reached first over the edges (ours).

    cylinders : kinematic cones, then cylinders
    vertices  : of the mesh
    F         : (face, corner)
    """
    label = np.full(vertices, -1)
    rows: list[tuple[bool, int, int, int]] = []
    for number, cylinder in enumerate(cylinders):
        used = np.unique(cylinder.annulus[cylinder.annulus >= 0])
        for position, k in enumerate(used):
            rigid = bool(cylinder.rigid[k])
            if position == 0 or rows[-1][0] != rigid:
                rows.append((rigid, number, int(k), int(k)))
            rows[-1] = (*rows[-1][:3], int(k))
            label[cylinder.annulus == k] = len(rows) - 1
    if not rows:
        return Areas(np.zeros_like(label), *(np.array([a]) for a in (True, 0, 0, 0)))
    E = edges(F)
    while (label < 0).any():
        before = label.copy()
        for a, b in (E.T, E[:, ::-1].T):
            reached = (before[b] < 0) & (before[a] >= 0)
            label[b[reached]] = before[a[reached]]
        if (label == before).all():
            label[label < 0] = 0
    return Areas(label, *(np.array(column) for column in zip(*rows, strict=True)))


def _without_shared_end(own: Ints, rigid: Flags, overlapping: Flags) -> Ints:
    """(vertex,) the annuli of one cone up to the farthest rigid area that overlaps; all if none does, or only that of the leaf.

    own, overlapping : (vertex,) annulus, −1 beyond the cone · whether another cone has it too
    rigid            : (annulus,)
    """
    last = int(own.max(initial=-1))
    is_shared = np.bincount(own[overlapping & (own >= 0)], minlength=last + 1) > 0
    shared = np.flatnonzero(rigid[: last + 1] & is_shared)
    if not len(shared):
        return own
    before = np.flatnonzero(~rigid[: shared[-1]])
    return np.where(own > before[-1], -1, own) if len(before) else own


def _widest_extension(
    cone_of: Ints, band: list[Ints], dead_end: list[Flags], distance: Floats, area: Floats, E: Ints
) -> tuple[int, Ints] | None:
    """The cone whose extension into the undefined area has the widest range of distances, and (vertex,) the annuli of that.

    An extension begins behind the last annulus of its cone. What lies beside nearer annuli is no ring: another cone shares it.
    """
    best: tuple[float, int, Ints] | None = None
    for n, own in enumerate(band):
        last = int(own[cone_of == n].max(initial=-1))
        end = neighbours((cone_of == n) & (own == last), E)
        annulus = grown(np.where((cone_of == -1) & (own > last), own, -1), end, area, E, dead_end=dead_end[n])
        if (annulus >= 0).any():
            wide = float(np.ptp(distance[n][annulus >= 0]))
            if best is None or wide > best[0]:
                best = (wide, n, annulus)
    return best[1:] if best else None
