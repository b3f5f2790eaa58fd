"""Where parts meet and the points they turn about: rotation centres with a prior that scales itself (2014, Sec. 6.3; ours).

A joint that turns about one line only leaves its place along that line open: there the middle of the border decides,
with a weight that grows with the noise and shrinks with the border's width.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints

SPREAD = 0.5  # standard deviation of a joint about the middle of its border, in radii of the border
ROUNDS = 4
SLENDER = 20.0
"""Length of a line, in radii, at which it is taken for wider than it is: a single edge has a width."""


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

    V     : (vertex, xyz) mesh unit
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
    trust: Floats | None = None,
    *,
    spread: float = SPREAD,
    alike: float = np.inf,
    far: float = np.inf,
) -> Joints:
    """Rotation centres, c = argmin Σ_t w_t |(R_a − R_b) c − (t_b − t_a)|² + Σ_t w_t (σ / (ρ r))² |c − c₀|², w robust.

    R        : (frame, part, 3, 3), t : (frame, part, xyz), from the reference to each frame
    pair     : (border, 2) the parts a, b
    centre   : (border, xyz) c₀, radius : (border,) r, mesh unit
    residual : (frame, part) what a part's motion leaves unexplained, mesh unit; the least that σ can be
    trust    : (frame, part) weight of each part in each frame; None believes all
    spread   : ρ, standard deviation of a joint about c₀, in r
    far      : distance from c₀, in r, at which a joint is held twice as firmly
    alike    : frames that err alike even where neighbours do not, so that errors of more frames average out; all do not
    """
    a, b = pair[:, 0], pair[:, 1]
    M, d = R[:, a] - R[:, b], t[:, b] - t[:, a]
    believed = np.ones(M.shape[:2]) if trust is None else np.minimum(trust[:, a], trust[:, b]) + 1e-3
    floor = np.sqrt((residual[:, a] ** 2 + residual[:, b] ** 2).mean(axis=0)) + 1e-4 * radius
    c, w, sigma, r = centre, believed, floor, np.maximum(radius, np.finfo(float).tiny)
    for _ in range(ROUNDS):
        held = 1.0 + (np.linalg.norm(c - centre, axis=1) / (far * r)) ** 2
        stiff = held * w.sum(axis=0) * (sigma / (spread * r)) ** 2
        A = np.einsum("tj,tjxy,tjxz->jyz", w, M, M) + stiff[:, None, None] * np.eye(3)
        g = np.einsum("tj,tjxy,tjx->jy", w, M, d) + stiff[:, None] * centre
        c = np.linalg.solve(A, g[..., None])[..., 0]
        rest = np.einsum("tjxy,jy->tjx", M, c) - d
        away = np.linalg.norm(rest, axis=2)
        usual = np.maximum(np.median(away, axis=0), floor)
        w = believed / (1.0 + (away / (3.0 * usual)) ** 2)
        sigma = np.maximum(np.sqrt((w * away**2).sum(axis=0) / w.sum(axis=0)), floor) * np.sqrt(_lasting(rest, w, alike))
    drift = np.sqrt((believed * away**2).sum(axis=0) / believed.sum(axis=0))
    return Joints(c, drift)


def _lasting(rest: Floats, w: Floats, alike: float) -> Floats:
    """(border,) share of the variance of what is left that does not average out over the frames.

    All of it where frames err as their neighbours do, `alike` of T frames where each errs by itself.

    rest : (frame, border, xyz) mesh unit, w : (frame, border) weights
    """
    whole = np.maximum((w[:, :, None] * rest**2).sum(axis=(0, 2)), np.finfo(float).tiny)
    both = (np.sqrt(w[1:] * w[:-1])[:, :, None] * rest[1:] * rest[:-1]).sum(axis=(0, 2))
    agree = np.clip(both / whole, 0.0, 0.999)
    return np.minimum(alike / len(rest) * (1.0 + agree) / (1.0 - agree), 1.0)


def blend_error(V: Floats, F: Ints, x: Floats, label: Ints, pair: Ints, R: Floats, t: Floats) -> Floats:
    """(border,) what blends of a border's two parts leave of the motion of the vertices along it, root mean square, mesh unit.

    Where parts merely lie side by side, as two thighs do, the skin between them follows a third; 0 where none lies along it.
    """
    edge = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    edge = edge[label[edge[:, 0]] != label[edge[:, 1]]]
    of = np.sort(label[edge], axis=1)
    left = np.zeros(len(pair))
    for row, (a, b) in enumerate(pair):
        v = np.unique(edge[(of[:, 0] == a) & (of[:, 1] == b)])
        if len(v):
            ya = V[v] @ R[:, a].transpose(0, 2, 1) + t[:, a, None]
            apart = V[v] @ R[:, b].transpose(0, 2, 1) + t[:, b, None] - ya
            rest = x[:, v] - ya
            square = np.maximum((apart**2).sum(axis=(0, 2)), np.finfo(float).tiny)
            share = np.clip((apart * rest).sum(axis=(0, 2)) / square, 0.0, 1.0)
            left[row] = np.sqrt(((rest - share[:, None] * apart) ** 2).sum(axis=2).mean())
    return left
