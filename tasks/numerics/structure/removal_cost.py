"""What removing a part costs: motion that its neighbours, single or blended in pairs, do not explain (ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.structure.part_motion import median_of

MOST_NEIGHBOURS, MOST_BEYOND = 6, 3
"""Parts that may explain a part, for time only: neighbours with the longest borders, and the largest parts behind them."""


@compiled
def removal_cost(
    V: Floats,
    N: Floats,
    x: Floats,
    weight: Floats,
    area: Floats,
    member: Ints,
    part: int,
    other: Ints,
    touches: int,
    R: Floats,
    t: Floats,
    bone: float,
    slip: float,
    loose: float,
    quiet: float,
    spans: Ints,
) -> float:
    """L4 norm over frames of the root mean square motion that the part explains and other parts do not.

    The largest such norm over any of the spans counts: over all frames, or over those of a take that turns what others hold.

    Each vertex is explained by another part, or by a blend of two whose shares are the same in all frames, as in skinning.
    A slice of a joint is exactly such a blend, a bone between two others nearly one: so only short parts may be explained by
    blends. The part's own residual at its median vertex is taken off.

    V, N    : (vertex, xyz) reference, mesh unit · (vertex, xyz) its unit normals
    weight  : (frame, vertex) confidence, 0 to 1
    area    : (vertex,) mesh unit²
    member  : (sample,) vertices of the part at which the cost is measured
    other   : (candidate,) parts that may explain it, of which the first `touches` touch it
    R, t    : (frame, part, 3, 3) · (frame, part, xyz)
    bone    : 0 for a part that blends may explain, 1 for one that only single parts may explain, or between
    slip    : weight of a displacement along the surface against one across it, 0 to 1
    loose   : share of the part's own residual that is taken off
    quiet   : mean squared residual of noise, which all vertices have and which is not taken off, mesh unit²
    spans   : (span, 2) see `score_spans`
    returns : mesh unit
    """
    frames, count = x.shape[0], len(other)
    loss, mass = np.zeros(frames), np.zeros(frames)
    r, turned, sure = np.empty((count + 1, frames, 3)), np.empty((frames, 3)), np.empty(frames)
    E = np.empty((count + 1, count + 1))
    own_square = np.empty((len(spans), len(member)))
    here, turn, shift = np.empty((frames, 3)), np.empty((count + 1, frames, 3, 3)), np.empty((count + 1, frames, 3))
    for a in range(count + 1):
        p = other[a] if a < count else part
        turn[a], shift[a] = R[:, p], t[:, p]
    for k in range(len(member)):
        v = member[k]
        _turned_normals(N, weight, v, turn[count], turned, sure)
        for f in range(frames):
            for c in range(3):
                here[f, c] = x[f, v, c]
            mass[f] += area[v] * weight[f, v]
        for a in range(count + 1):
            _residuals(V[v], turned, here, sure, turn[a], shift[a], slip, r[a])
        _products(r, E)
        _add_loss(r, E, touches, bone, area[v], loss)
        for s in range(len(spans)):
            own_square[s, k] = _mean_square(r[count], weight, v, spans[s, 0], spans[s, 1])
    largest = 0.0
    for s in range(len(spans)):
        own = loose * max(median_of(own_square[s], len(member)) - quiet, 0.0)
        norm = _frame_norm(loss[spans[s, 0] : spans[s, 1]], mass[spans[s, 0] : spans[s, 1]])
        largest = max(largest, norm - own)
    return np.sqrt(largest)


@compiled
def candidates(near: Ints, size: Floats, part: int) -> tuple[Ints, int]:
    """Parts that may explain a part: its neighbours and the largest of theirs.

    near    : (part, part) edges between any two
    size    : (part,) area
    returns : (candidate,) parts · how many of them, the first, touch it
    """
    parts = len(near)
    rank = np.zeros(parts)
    for q in range(parts):
        if near[part, q] > 0:
            rank[q] = 1.0 + near[part, q]
            for p in range(parts):
                if near[q, p] > 0 and p != part and near[part, p] == 0:
                    rank[p] = size[p] / (size[p] + 1.0)
    out = np.empty(MOST_NEIGHBOURS + MOST_BEYOND, np.int64)
    count = touches = 0
    while count < len(out):
        best = 0
        for p in range(parts):
            if rank[p] > rank[best]:
                best = p
        if rank[best] <= 0.0 or (rank[best] < 1.0 and count - touches == MOST_BEYOND):
            break
        if rank[best] < 1.0 or touches < MOST_NEIGHBOURS:
            out[count] = best
            count += 1
            touches += rank[best] > 1.0
        rank[best] = 0.0
    return out[:count], touches


@compiled
def _turned_normals(N: Floats, weight: Floats, v: int, turn: Floats, turned: Floats, sure: Floats) -> None:
    """Writes (frame, xyz) the normal of a vertex as its part turns it, turn (frame, 3, 3), and (frame,) √w."""
    for f in range(len(turned)):
        sure[f] = np.sqrt(weight[f, v])
        for i in range(3):
            turned[f, i] = turn[f, i, 0] * N[v, 0] + turn[f, i, 1] * N[v, 1] + turn[f, i, 2] * N[v, 2]


@compiled
def _residuals(
    q: Floats, turned: Floats, here: Floats, sure: Floats, turn: Floats, shift: Floats, slip: float, out: Floats
) -> None:
    """Writes (frame, xyz) √w times the residual of a vertex under a part, less of it along the surface.

    q, here      : (xyz,) in the reference · (frame, xyz) in the frames, mesh unit
    turned, sure : see `_turned_normals`
    turn, shift  : (frame, 3, 3) · (frame, xyz) the part's motion
    """
    for f in range(len(here)):
        w = sure[f]
        across = 0.0
        for i in range(3):
            r = shift[f, i] - here[f, i] + turn[f, i, 0] * q[0] + turn[f, i, 1] * q[1] + turn[f, i, 2] * q[2]
            out[f, i] = w * slip * r
            across += turned[f, i] * r
        if slip < 1.0:
            for i in range(3):
                out[f, i] += w * (1.0 - slip) * across * turned[f, i]


@compiled
def _mean_square(r: Floats, weight: Floats, v: int, begin: int, end: int) -> float:
    """Mean squared residual of a vertex over some frames; r (frame, xyz) as `_residuals` writes it."""
    total, weight_sum = 0.0, 0.0
    for f in range(begin, end):
        total += r[f, 0] * r[f, 0] + r[f, 1] * r[f, 1] + r[f, 2] * r[f, 2]
        weight_sum += weight[f, v]
    return total / max(weight_sum, 1e-6)


@compiled
def _products(r: Floats, E: Floats) -> None:
    """Writes the lower triangle of E (candidate, candidate), products of residuals summed over frames, four sums at a time."""
    for a in range(len(r)):
        for b in range(0, a + 1, 4):
            c, d, e = min(b + 1, a), min(b + 2, a), min(b + 3, a)
            of_b, of_c, of_d, of_e = 0.0, 0.0, 0.0, 0.0
            for f in range(r.shape[1]):
                i, j, k = r[a, f, 0], r[a, f, 1], r[a, f, 2]
                of_b += i * r[b, f, 0] + j * r[b, f, 1] + k * r[b, f, 2]
                of_c += i * r[c, f, 0] + j * r[c, f, 1] + k * r[c, f, 2]
                of_d += i * r[d, f, 0] + j * r[d, f, 1] + k * r[d, f, 2]
                of_e += i * r[e, f, 0] + j * r[e, f, 1] + k * r[e, f, 2]
            E[a, b], E[a, c], E[a, d], E[a, e] = of_b, of_c, of_d, of_e


@compiled
def _add_loss(r: Floats, E: Floats, touches: int, bone: float, area: float, loss: Floats) -> None:
    """Adds (frame,) the squared residual of a vertex, times area, that the part takes away, see `removal_cost`.

    r, E : (candidate, frame, xyz) residuals, the part's own last · (candidate, candidate) see `_products`
    """
    count = len(r) - 1
    best = _best_single(E, touches)
    i, j, w, without_part = _best_blend(E, 0, count)
    m, n, u, with_part = _best_blend(E, count, count + 1)
    if without_part < with_part:
        m, n, u = i, j, w
    for f in range(len(loss)):
        for c in range(3):
            with_it = u * r[m, f, c] + (1.0 - u) * r[n, f, c]
            blend = w * r[i, f, c] + (1.0 - w) * r[j, f, c]
            loss[f] += area * (bone * r[best, f, c] ** 2 + (1.0 - bone) * blend * blend - with_it * with_it)


@compiled
def _best_single(E: Floats, high: int) -> int:
    """The one before `high` that leaves least."""
    best = 0
    for a in range(1, high):
        if E[a, a] < E[best, best]:
            best = a
    return best


@compiled
def _best_blend(E: Floats, low: int, high: int) -> tuple[int, int, float, float]:
    """The two whose blend leaves least, one of them from `low` on and below `high`, the other before it.

    returns : first · second · share of the first · what is left; a single one is a blend with itself
    """
    first, second, share, least = low, low, 1.0, np.inf
    for a in range(low, high):
        if E[a, a] < least:
            first, second, share, least = a, a, 1.0, E[a, a]
        for b in range(a):
            bend = E[a, a] - 2.0 * E[a, b] + E[b, b]
            if bend <= 0.0:
                continue
            w = (E[b, b] - E[a, b]) / bend
            if 0.0 < w < 1.0 and E[b, b] - w * w * bend < least:
                first, second, share, least = a, b, w, E[b, b] - w * w * bend
    return first, second, share, least


@compiled
def _frame_norm(loss: Floats, mass: Floats) -> float:
    """Root mean square over frames of the mean squared residual, each frame by its confident area.

    loss    : (frame,) mesh unit⁴, squared residuals times area
    mass    : (frame,) mesh unit², area times confidence
    returns : mesh unit²
    """
    full, total, frame_weight = 1e-300, 0.0, 1e-300
    for f in range(len(loss)):
        full = max(full, mass[f])
    for f in range(len(loss)):
        if mass[f] > 0.0:
            total += mass[f] / full * max(loss[f] / mass[f], 0.0) ** 2
            frame_weight += mass[f] / full
    return np.sqrt(total / frame_weight)
