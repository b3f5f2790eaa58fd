"""How parts move by their cores: the skin about a joint bends, the middle of a limb does not (ours).

Where every vertex was followed, a part's motion is fitted again to the vertices that it explains best. The scale of what counts
as well explained falls from round to round, from the median of a part's vertices to those of a small share of its area. A part
that has a core is explained there many times better than as a whole; one that bends everywhere is not, and moves as before.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.rigid_fit import nearest_rotation


class RigidCoresSettings(NamedTuple):
    """What a core is."""

    share: float = 0.15
    """Share of a part's area that its core has, at least. Chosen on a dance and on generated bodies of even seeds: with 0.08 as
    much is won there, with 0.25 a third less."""
    clearer: float = 0.4
    """What a core's own motion leaves there, share of what the part's leaves where it is clearly rigid, at most. Chosen alike:
    with 0.25 less is won; with 0.6 the trunk of a wolf, which bends everywhere, gets worse."""
    rounds: int = 12
    """Rounds of weights and motion; in the first two thirds the scale falls."""
    least_vertices: int = 12
    """Vertices of a part, at least. Not varied."""
    least_alike: float = 4.0
    """Vertices of like weight that a core has, at least, (Σ w)² / Σ w²: one or two are explained by many a motion. Chosen on
    drawn parts that bend everywhere: of 12 vertices 32 in 40 have a core without it, none with it. With 6 and more, feet of
    generated people of 3,000 vertices, which have 31, lose a true core."""
    exact: float = 1e-6
    """Distance below which vertices are explained alike, share of the root of the area. Not varied."""


class PartMotion(NamedTuple):
    """R (frame, 3, 3) · t (frame, xyz) from the reference, mesh unit · residual (frame,) what they leave, mesh unit."""

    R: Floats
    t: Floats
    residual: Floats


def core_motions(
    V: Floats, x: Floats, area: Floats, label: Ints, R: Floats, t: Floats, residual: Floats,
    settings: RigidCoresSettings | None = None,
) -> tuple[Floats, Floats, Floats]:  # fmt: skip
    """Motions of parts and what they leave, those with a core by their cores alone.

    V, x     : (vertex, xyz) · (frame, vertex, xyz) mesh unit, every vertex followed
    area     : (vertex,) mesh unit²
    label    : (vertex,) part
    R, t     : (frame, part, 3, 3) · (frame, part, xyz) from the reference, to begin from
    residual : (frame, part) what they leave of clearly rigid vertices, mesh unit
    returns  : the same three, of other motions
    """
    chosen, size = settings or RigidCoresSettings(), float(np.sqrt(area.sum()))
    R, t, residual = R.copy(), t.copy(), residual.copy()
    for part in range(R.shape[1]):
        own = np.flatnonzero(label == part)
        if len(own) < chosen.least_vertices or not area[own].sum() > 0.0:
            continue
        start = PartMotion(R[:, part], t[:, part], residual[:, part])
        core, alike = core_motion(V[own], x[:, own], area[own], start, size, chosen)
        if alike >= chosen.least_alike and (core.residual**2).mean() < chosen.clearer**2 * (start.residual**2).mean():
            R[:, part], t[:, part], residual[:, part] = core
    return R, t, residual


def core_motion(
    V: Floats, x: Floats, area: Floats, start: PartMotion, size: float, settings: RigidCoresSettings
) -> tuple[PartMotion, float]:
    """The motion of one part's core: least Σ a |R q + t − x|² (s² / (s² + e))², e the mean square of a vertex over the frames.

    V, x, area : of the part's vertices
    size       : root of the body's area, mesh unit
    returns    : that motion, and as how many vertices of like weight the core counts
    """
    chosen, T = settings, len(x)
    q, shift = V - area @ V / area.sum(), (area @ x.swapaxes(0, 1).reshape(len(V), -1) / area.sum()).reshape(T, 1, 3)
    X = np.ascontiguousarray((x - shift).transpose(1, 0, 2)).reshape(len(V), -1)
    R, t = start.R, start.t + start.R @ (V - q)[0] - shift[:, 0]
    floor, falling, weight = (chosen.exact * size) ** 2, max(2 * chosen.rounds // 3, 1), area
    for turn in range(chosen.rounds):
        e = (_off(q, X, R, t) ** 2).sum(axis=1) / T
        share = 0.5 * (chosen.share / 0.5) ** min(turn / falling, 1.0)
        scale = max(_quantile(e, area, share), floor)
        weight = area * (scale / (scale + e)) ** 2
        R, t = _fitted(q, X, weight)
    left = np.sqrt((weight @ _off(q, X, R, t) ** 2).reshape(T, 3).sum(axis=1) / weight.sum())
    return PartMotion(R, t + shift[:, 0] - R @ (V - q)[0], left), float(weight.sum() ** 2 / (weight**2).sum())


def _off(q: Floats, X: Floats, R: Floats, t: Floats) -> Floats:
    """(vertex, 3 · frame) R q + t − x; X (vertex, 3 · frame)."""
    return np.asarray(q @ np.ascontiguousarray(R.transpose(2, 0, 1)).reshape(3, -1) + t.reshape(-1) - X)


def _fitted(q: Floats, X: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """(frame, 3, 3) · (frame, xyz) the rigid motions of least error."""
    share = weight / weight.sum()
    middle, centre = share @ q, share @ X
    H = ((share[:, None] * (q - middle)).T @ X).reshape(3, -1, 3).transpose(1, 2, 0)
    R = nearest_rotation(H)
    return R, centre.reshape(-1, 3) - R @ middle


def _quantile(e: Floats, weight: Floats, share: float) -> float:
    """The value of e below which this share of the weight lies."""
    order = np.argsort(e, kind="stable")
    total = np.cumsum(weight[order])
    return float(e[order[np.searchsorted(total, share * total[-1])]])
