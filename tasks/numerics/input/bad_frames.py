"""Which frames of a sequence cannot be of the same body as the others: sizes, places and pieces against the medians (ours)."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.errors import SourceError
from kinetree.tasks.numerics.arrays import Faces, Floats
from kinetree.tasks.numerics.input.body_changes import body_changes, other_bodies


class BadFrameSettings(NamedTuple):
    """Beyond which a frame is not of the same body; far outside of what poses, contacts and lost limbs do."""

    area: float = 3.0
    """Factor between a frame's area and the median; a limb has at most a third of the area. 3 is a scale of 1.7."""
    size: float = 3.0
    """Factor between a frame's size and the median; curled up to stretched out is less than 2."""
    vertices: float = 20.0
    """Factor between a frame's number of vertices and the median."""
    pieces: int = 6
    """Pieces of 5 % of the area beyond the median number: the surface is torn."""
    second: float = 1.5
    """Factor between the area of a frame with more large pieces than most and the median: another body is in it. Poses change
    the area of one body by 1.08 at most, and a limb that comes off does not add to it."""
    distance: float = 4.0
    """Sizes and usual steps between a frame's centre and the median of the frames around it."""
    window: int = 3
    """Frames on either side with which the place of a frame is compared."""
    tail: float = 0.05
    """Share of the area at either end of each axis that size and centre leave out, so that debris does not count."""
    takes: float = 1.3
    """Factor between the median areas or volumes of two takes; between two frames of one body at most 1.08 and 1.16."""
    open: float = 0.05
    """Length of the mean normal, weighted by area, from which on a surface encloses no volume; 0 where it is closed."""
    least: int = 3
    """Frames from which on there is a median to compare with."""


class FrameMeasures(NamedTuple):
    """What one frame's surface is like.

    Area length², infinite where no number holds it; size length; centre (xyz); vertices; pieces of 5 % of the area; volume
    length³ or 0 where the surface is open.
    """

    area: float
    size: float
    centre: tuple[float, float, float]
    vertices: int
    pieces: int
    volume: float


def frame_measures(V: Floats, F: Faces) -> FrameMeasures:
    """Area, size and centre without debris, vertices in faces, large pieces and volume of a surface.

    V, F : (vertex, xyz) mesh unit · (face, corner)
    """
    from scipy.sparse import coo_array  # to look at frames that were measured before does without
    from scipy.sparse.csgraph import connected_components

    from kinetree.tasks.numerics.geometry.normals import face_areas

    tail = BadFrameSettings().tail
    scale = float(np.abs(V[F]).max()) or 1.0
    X = np.clip(V / scale, -1.0, 1.0)  # a stray vertex that no face has may lie anywhere
    areas = face_areas(X, F)
    total = float(areas.sum())
    weight = areas if total > 0 else np.ones(len(F))
    middle = X[F].mean(axis=1)
    low, mid, high = np.array([_quantiles(middle[:, k], weight, (tail, 0.5, 1 - tail)) for k in range(3)]).T * scale
    _, same = np.unique(V, axis=0, return_inverse=True)  # seams do not tear a surface
    G = same.reshape(-1)[F]
    n = int(same.max()) + 1
    links = coo_array((np.ones(2 * len(G), bool), (G[:, [0, 1]].ravel(), G[:, [1, 2]].ravel())), shape=(n, n))
    _, piece = connected_components(links, directed=False)
    shares = np.bincount(piece[G[:, 0]], weight) / weight.sum()
    x, y, z = map(float, mid)
    with np.errstate(over="ignore"):
        area, volume = (float(total * np.float64(scale) ** 2), float(_volume(X, F, total) * np.float64(scale) ** 3))
        size = float(np.linalg.norm(high - low))
    return FrameMeasures(area, size, (x, y, z), n, int((shares >= tail).sum()), volume if np.isfinite(volume) else 0.0)


def bad_frames(measured: Mapping[int, FrameMeasures | str], settings: BadFrameSettings | None = None) -> dict[int, str]:
    """Frames that could not be measured or stand out from the others, each with the reason.

    measured : by frame number, ascending; a text says why a frame cannot be read
    """
    limit = settings or BadFrameSettings()
    bad: dict[int, str] = {t: m for t, m in measured.items() if isinstance(m, str)}
    surfaces = {t: m for t, m in measured.items() if not isinstance(m, str)}
    bad |= {t: "its faces have no area; export the frame again" for t, m in surfaces.items() if m.area <= 0}
    bad |= {t: "its coordinates are so large that no number holds its area" for t, m in surfaces.items() if m.area == np.inf}
    good = {t: m for t, m in surfaces.items() if t not in bad}
    if len(good) < limit.least:
        return dict(sorted(bad.items()))
    bad |= _of_another_size(good, limit)
    bad |= _elsewhere({t: m for t, m in good.items() if t not in bad}, limit)
    return dict(sorted(bad.items()))


def frames_of_other_bodies(measured: Mapping[int, FrameMeasures]) -> dict[int, str]:
    """Frames of another body than most, where a sequence goes on with one of another size, each with the reason.

    measured : by frame number, ascending; the frames that are not bad
    """
    volume = np.array([m.volume for m in measured.values()])
    begins = body_changes(np.array([m.area for m in measured.values()]), volume)
    if not len(begins):
        return {}
    frames = np.array(list(measured))
    is_other = other_bodies(volume, begins)
    usual = float(np.median(volume[~is_other & (volume > 0)]))
    reasons: dict[int, str] = {}
    for rows in np.split(np.arange(len(frames)), begins):
        own = volume[rows][volume[rows] > 0]
        reason = (
            f"frames {frames[rows[0]]} to {frames[rows[-1]]} show another body: their volume is {np.median(own):.4g},"
            f" that of the others {usual:.4g}; compute them by themselves, or set source.other_body=keep"
        )
        reasons |= {int(t): reason for t in frames[rows[is_other[rows]]]}
    return reasons


def refuse_bad(bad: Mapping[int, str], count: int, share: float | None) -> None:
    """Refuses a sequence with bad frames, or with more of them than a share; None allows none. Raises SourceError."""
    if not bad or (share is not None and len(bad) <= share * count):
        return
    reasons = list(dict.fromkeys(text if text.startswith("frames ") else f"frame {t}: {text}" for t, text in bad.items()))
    named = "; ".join(reasons[:3])
    more = f"; and {len(reasons) - 3} more" if len(reasons) > 3 else ""
    remedy = "set source.on_bad_frame=drop to go on without them" if share is None else f"source.bad_share allows {share:g}"
    raise SourceError(f"{len(bad)} of {count} frames cannot be used ({remedy}): {named}{more}")


def refuse_other_bodies(measured: Mapping[str, Sequence[FrameMeasures]], settings: BadFrameSettings | None = None) -> None:
    """Refuses takes whose bodies are not as large as that of the first, by area or volume; raises SourceError.

    measured : by name of the take, in their order; takes that are no meshes yet have none
    """
    limit = (settings or BadFrameSettings()).takes
    for what in ("area", "volume"):
        usual = {name: float(np.median([getattr(m, what) for m in frames])) for name, frames in measured.items() if frames}
        usual = {name: value for name, value in usual.items() if value > 0}
        first = next(iter(usual), "")
        for name, value in usual.items():
            if not usual[first] / limit <= value <= usual[first] * limit:
                raise SourceError(
                    f"take {name} is not of the same body as take {first}: the median {what} of its frames is {value:.4g}, not"
                    f" {usual[first]:.4g}; is it in another unit? Compute it by itself, or leave it out"
                )


def _of_another_size(good: Mapping[int, FrameMeasures], limit: BadFrameSettings) -> dict[int, str]:
    """Frames whose size, area, vertices or pieces are not those of the others."""
    bad: dict[int, str] = {}
    for name, most in (("size", limit.size), ("area", limit.area), ("vertices", limit.vertices)):
        values = np.array([float(getattr(m, name)) for m in good.values()])
        median = float(np.median(values))
        for t, value in zip(good, values, strict=True):
            if not median / most <= value <= median * most:
                hint = "; is it in another unit?" if name == "size" else ""
                have = {"size": "size is", "area": "area is", "vertices": "number of vertices is"}[name]
                bad.setdefault(t, f"its {have} {value:.4g}, in the median of all frames {median:.4g}{hint}")
    usual = int(np.median([m.pieces for m in good.values()]))
    area = float(np.median([m.area for m in good.values()]))
    for t, m in good.items():
        if m.pieces > usual + limit.pieces:
            bad.setdefault(t, f"its surface is torn into {m.pieces} large pieces, that of most frames has {usual}")
        elif m.pieces > usual and m.area > limit.second * area:
            more = f"{m.pieces} large pieces and {m.area / area:.3g} times the area, most frames have {usual}"
            bad.setdefault(t, f"another body is in it: it has {more}")
    return bad


def _elsewhere(good: Mapping[int, FrameMeasures], limit: BadFrameSettings) -> dict[int, str]:
    """Frames far from where the frames around them are."""
    C = np.array([m.centre for m in good.values()])
    if len(C) < limit.least:
        return {}
    size = float(np.median([m.size for m in good.values()]))
    steps = np.linalg.norm(np.diff(C, axis=0), axis=1)
    allowed = limit.distance * (size + float(np.quantile(steps, 0.5, method="lower")))  # one bad frame spoils two steps
    bad = {}
    for i, t in enumerate(good):
        around = np.median(C[max(0, i - limit.window) : i + limit.window + 1], axis=0)
        distance = float(np.linalg.norm(C[i] - around))
        if distance > allowed:
            bad[t] = f"it lies {distance / size:.3g} sizes of the body away from the frames around it"
    return bad


def _volume(V: Floats, F: Faces, area: float) -> float:
    """The volume that a nearly closed surface encloses; 0 where it is open, or turned over in places."""
    X = V - V[F].mean(axis=(0, 1))
    doubled = np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]])
    if float(np.linalg.norm(doubled.sum(axis=0))) > 2 * BadFrameSettings().open * area:
        return 0.0
    return abs(float(np.einsum("ij,ij->", X[F[:, 0]], doubled))) / 6


def _quantiles(values: Floats, weight: Floats, shares: tuple[float, ...]) -> list[float]:
    """The values below which a share of the weight lies."""
    order = np.argsort(values)
    below = np.cumsum(weight[order])
    at = np.searchsorted(below, np.array(shares) * below[-1])
    return [float(values[order[min(i, len(order) - 1)]]) for i in at]
