"""Where parts meet and the points they turn about: rotation centres with a prior that scales itself (2014, Sec. 6.3; ours).

A joint that turns about one line only leaves its place along that line open: there the middle of the border decides,
with a weight that grows with the noise and shrinks with the width of the border.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.centre_lines import about_lines

ROUNDS = 4
"""Rounds of weighting frames anew; the centres no longer move by then."""
SLENDER = 20.0
"""Length of a border, in its radii, beyond which the radius is that length by this: a single edge has a width."""


class RotationCentresSettings(NamedTuple):
    """How firmly a joint is held where it is expected; lengths are in radii of the border."""

    spread: float = 0.5
    """Standard deviation of a joint about the middle of its border. Not recorded."""
    across: float = 0.5
    """The same across the centre line of a long part, where lines are given; as elsewhere unless it is told."""
    along: float = 0.5
    """The same along that line."""
    frames_alike: float = np.inf
    """Frames that err alike even where neighbours do not, so that errors of more frames average out; infinite: all do."""
    far: float = np.inf
    """Distance from where it is expected at which a joint is held twice as firmly; infinite: never."""
    outlier: float = 3.0
    """Distance of a frame's error, in medians over the frames, at which the frame counts a half. Not recorded."""


class Borders(NamedTuple):
    """Where the labels of a surface change.

    pair   : (border, 2) parts that meet, the smaller number first, ascending
    centre : (border, xyz) middle of the line between them, mesh unit
    radius : (border,) root mean square distance of the line from its middle, mesh unit
    length : (border,) of the line, mesh unit
    """

    pair: Ints
    centre: Floats
    radius: Floats
    length: Floats


class Joints(NamedTuple):
    """A rotation centre for every border.

    rest  : (border, xyz) in the reference mesh
    drift : (border,) root mean square distance between the point as its two parts carry it, mesh unit
    """

    rest: Floats
    drift: Floats


def borders(V: Floats, F: Ints, label: Ints) -> Borders:
    """The lines along which parts meet, through the middles of the edges that cross from one part to another.

    V, F  : (vertex, xyz) mesh unit · (face, corner)
    label : (vertex,) part, 0 or more
    """
    count = int(label.max(initial=-1)) + 1
    pairs, middles, lengths = [], [], []
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        # within a face the line runs from edge ij to edge ik around corner i, where i stands alone or all three differ
        a, b, c = label[F[:, i]], label[F[:, j]], label[F[:, k]]
        crossing = (a != b) & (a != c)
        p, q, r = (V[F[crossing, n]] for n in (i, j, k))
        length = np.linalg.norm(q - r, axis=1) / 2
        for other, far in ((b, q), (c, r)):
            pairs.append(np.sort(np.stack([a, other], axis=1)[crossing], axis=1))
            middles.append((p + far) / 2)
            lengths.append(np.maximum(length / 2, np.finfo(float).tiny))
    pair, middle, weight = np.concatenate(pairs), np.concatenate(middles), np.concatenate(lengths)
    key, row = np.unique(pair[:, 0] * count + pair[:, 1], return_inverse=True)
    length = np.bincount(row, weight, len(key))
    centre = np.stack([np.bincount(row, weight * middle[:, x], len(key)) / length for x in range(3)], axis=1)
    square: Floats = np.bincount(row, weight * ((middle - centre[row]) ** 2).sum(axis=1), len(key)) / length
    return Borders(
        np.stack([key // max(count, 1), key % max(count, 1)], axis=1),
        centre,
        np.maximum(np.sqrt(square), length / SLENDER),
        np.asarray(length, dtype=np.float64),
    )


def rotation_centres(
    R: Floats,
    t: Floats,
    pair: Ints,
    centre: Floats,
    radius: Floats,
    residual: Floats,
    confidence: Floats | None = None,
    settings: RotationCentresSettings | None = None,
    lines: Floats | None = None,
) -> Joints:
    """Rotation centres, c = argmin Σ_t w_t |(R_a − R_b) c − (t_b − t_a)|² + Σ_t w_t (σ / r)² (c − c₀)ᵀ P (c − c₀), w robust.

    The rotation centre is that of 2014, Sec. 6.3 (Ehrig et al. 2006); the prior, whose weight grows with the noise, is ours.
    P = I / ρ². Where lines are given P = (1 − tr L) I / ρ² + (tr L I − L) / across² + L / along², and σ is what is left where
    joints are held in all directions as along a line: where a line is wrong, what it leaves would hold the joint on it.

    R          : (frame, part, 3, 3), t : (frame, part, xyz), from the reference to each frame
    pair       : (border, 2) the parts a, b
    centre     : (border, xyz) c₀, radius : (border,) r, mesh unit
    residual   : (frame, part) what a part's motion leaves unexplained, mesh unit; the least that σ can be
    confidence : (frame, part) weight of each part in each frame; None weighs all alike
    lines      : (border, 3, 3) L = Σ w a aᵀ over the lines on which joints are expected, see `ExpectedJoints`; None for none
    """
    chosen = settings or RotationCentresSettings()
    certain = _certain(confidence, pair, len(R))
    motion = _Motion(R[:, pair[:, 0]] - R[:, pair[:, 1]], t[:, pair[:, 1]] - t[:, pair[:, 0]], certain)
    floor = np.sqrt((residual[:, pair[:, 0]] ** 2 + residual[:, pair[:, 1]] ** 2).mean(axis=0)) + 1e-4 * radius
    expected = _Expected(centre, np.maximum(radius, np.finfo(float).tiny), floor)
    if lines is None:
        c, _ = _centres(motion, expected, np.eye(3) / chosen.spread**2, chosen)
    else:
        _, sigma = _centres(motion, expected, np.eye(3) / chosen.along**2, chosen)
        firm = about_lines(lines, chosen.spread**-2, chosen.across**-2, chosen.along**-2)
        c, _ = _centres(motion, expected, firm, chosen, sigma)
    return Joints(c, drift(R, t, pair, c, confidence))


class _Motion(NamedTuple):
    """Where two parts carry a joint c alike M c = d: M (frame, joint, 3, 3), d (frame, joint, xyz), weights (frame, joint)."""

    M: Floats
    d: Floats
    certain: Floats


class _Expected(NamedTuple):
    """Where joints are expected (joint, xyz), the radius of their borders (joint,), and the least that σ can be (joint,)."""

    centre: Floats
    radius: Floats
    floor: Floats


def _centres(
    motion: _Motion, expected: _Expected, P: Floats, chosen: RotationCentresSettings, error: Floats | None = None
) -> tuple[Floats, Floats]:
    """(joint, xyz) rotation centres · (joint,) σ of what both parts' motions leave there, mesh unit.

    P     : (joint, 3, 3) or (3, 3) how firmly joints are held where they are expected, 1 / radius²
    error : (joint,) σ by which they are held, mesh unit; None takes what is left, round by round
    """
    M, d, certain = motion
    centre, r, floor = expected
    c, w, sigma = centre, certain, floor if error is None else error
    left = floor
    for _ in range(ROUNDS):
        held = 1.0 + (np.linalg.norm(c - centre, axis=1) / (chosen.far * r)) ** 2
        stiff = (held * w.sum(axis=0) * (sigma / r) ** 2)[:, None, None] * P
        A = np.einsum("tj,tjxy,tjxz->jyz", w, M, M) + stiff
        g = np.einsum("tj,tjxy,tjx->jy", w, M, d) + np.einsum("jxy,jy->jx", stiff, centre)
        c = np.linalg.solve(A, g[..., None])[..., 0]
        off = np.einsum("tjxy,jy->tjx", M, c) - d
        away = np.linalg.norm(off, axis=2)
        usual = np.maximum(np.median(away, axis=0), floor)
        w = certain / (1.0 + (away / (chosen.outlier * usual)) ** 2)
        usual = np.maximum(np.sqrt((w * away**2).sum(axis=0) / w.sum(axis=0)), floor)
        left = usual * np.sqrt(_lasting(off, w, chosen.frames_alike))
        sigma = left if error is None else error
    return c, left


def drift(R: Floats, t: Floats, pair: Ints, centre: Floats, confidence: Floats | None = None) -> Floats:
    """(border,) root mean square distance between a point as its two parts carry it, mesh unit.

    R, t, pair, confidence : as in `rotation_centres`
    centre                 : (border, xyz) the point in the reference
    """
    a, b = pair[:, 0], pair[:, 1]
    error = np.einsum("tjxy,jy->tjx", R[:, a] - R[:, b], centre) - (t[:, b] - t[:, a])
    certain = _certain(confidence, pair, len(R))
    square: Floats = (certain * np.linalg.norm(error, axis=2) ** 2).sum(axis=0) / certain.sum(axis=0)
    return np.sqrt(square)


def widest_drift(R: Floats, t: Floats, pair: Ints, centre: Floats, spans: Ints) -> Floats:
    """(border,) the largest `drift` over any of the spans (span, 2), see `score_spans`, mesh unit.

    R, t, pair, centre : as in `drift`; every part is certain
    """
    return np.max([drift(R[begin:end], t[begin:end], pair, centre) for begin, end in spans], axis=0)


def _certain(confidence: Floats | None, pair: Ints, frames: int) -> Floats:
    """(frame, border) weight of every frame: the confidence of the less certain of two parts."""
    if confidence is None:
        return np.ones((frames, len(pair)))
    weight: Floats = np.minimum(confidence[:, pair[:, 0]], confidence[:, pair[:, 1]]) + 1e-3
    return weight


def _lasting(error: Floats, w: Floats, alike: float) -> Floats:
    """(border,) share of the variance of the errors that does not average out over the frames.

    All of it where frames err as their neighbours do, `alike` of T frames where each errs by itself.

    error : (frame, border, xyz) mesh unit, w : (frame, border) weights
    """
    whole = np.maximum((w[:, :, None] * error**2).sum(axis=(0, 2)), np.finfo(float).tiny)
    both = (np.sqrt(w[1:] * w[:-1])[:, :, None] * error[1:] * error[:-1]).sum(axis=(0, 2))
    agree = np.clip(both / whole, 0.0, 0.999)
    return np.minimum(alike / len(error) * (1.0 + agree) / (1.0 - agree), 1.0)


def blend_error(V: Floats, F: Ints, x: Floats, label: Ints, pair: Ints, R: Floats, t: Floats) -> Floats:
    """How badly blends of a border's two parts explain the vertices along it (ours).

    Where parts merely lie side by side, as two thighs do, the skin between them follows a third part.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    x       : (frame, vertex, xyz) mesh unit
    label   : (vertex,) part
    pair    : (border, 2) parts
    R, t    : (frame, part, 3, 3), (frame, part, xyz)
    returns : (border,) root mean square distance, mesh unit; 0 where no vertex lies along a border
    """
    edge = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    edge = edge[label[edge[:, 0]] != label[edge[:, 1]]]
    of = np.sort(label[edge], axis=1)
    error = np.zeros(len(pair))
    for row, (a, b) in enumerate(pair):
        v = np.unique(edge[(of[:, 0] == a) & (of[:, 1] == b)])
        if len(v):
            ya = V[v] @ R[:, a].transpose(0, 2, 1) + t[:, a, None]
            apart = V[v] @ R[:, b].transpose(0, 2, 1) + t[:, b, None] - ya
            offset = x[:, v] - ya
            square = np.maximum((apart**2).sum(axis=(0, 2)), np.finfo(float).tiny)
            share = np.clip((apart * offset).sum(axis=(0, 2)) / square, 0.0, 1.0)
            error[row] = np.sqrt(((offset - share[:, None] * apart) ** 2).sum(axis=2).mean())
    return error
