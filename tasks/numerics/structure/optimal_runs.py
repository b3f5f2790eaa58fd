"""The optimal cut of a chain of rings into rigid runs (after 2014, Sec. 6.1.2; by dynamic programming, not by growth)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.rigid_fit import MOMENTS, residual
from kinetree.tasks.numerics.structure.patch_merging import costs


@compiled
def runs(M: Floats, penalty: float, least: int) -> Ints:
    """The cut of a chain of rings that minimises Σ residual of the runs + penalty · (number of runs); ours.

    M       : (ring, frame, 17) sums of every ring, from the leaf on; see `rigid_fit.MOMENTS`
    penalty : what one more run must save, mesh unit² times weight
    least   : rings in a run; the whole chain is one run if it has fewer than two such
    returns : (ring,) number of the run of every ring, ascending from 0
    """
    count, frames = M.shape[0], M.shape[1]
    run = np.zeros(count, np.int64)
    if count < 2 * least:
        return run
    best = np.full(count + 1, np.inf)
    before = np.zeros(count + 1, np.int64)
    best[0] = 0.0
    total = np.empty((frames, MOMENTS))
    for i in range(count - least + 1):
        if not np.isfinite(best[i]):
            continue
        for t in range(frames):
            for k in range(MOMENTS):
                total[t, k] = 0.0
        for j in range(i, count):
            for t in range(frames):
                for k in range(MOMENTS):
                    total[t, k] += M[j, t, k]
            if j + 1 - i < least:
                continue
            cost = best[i] + penalty
            for t in range(frames):
                cost += residual(total[t])
                if cost >= best[j + 1] and t % 8 == 7:
                    break
            if cost < best[j + 1]:
                best[j + 1] = cost
                before[j + 1] = i
            elif best[i] + penalty > best[count]:
                break
    cut = np.zeros(count + 1, np.bool_)
    j = count
    end = count
    while end > 0:
        end = before[end]
        cut[end] = True
    number = -1
    for k in range(count):
        number += cut[k]
        run[k] = number
    return run


def merge_growth(M: Floats, reach: int) -> Floats:
    """Growth of the rigid residual when the rings before a border and the rings behind it become one rigid piece.

    M       : (ring, frame, 17) sums of every ring; see `rigid_fit.MOMENTS`
    reach   : rings that count on either side, fewer at the ends of the chain
    returns : (ring − 1,) for the border behind every ring but the last, mesh unit² times weight, summed over frames
    """
    up_to = np.concatenate([np.zeros((1, *M.shape[1:])), np.cumsum(M, axis=0)])
    border = np.arange(1, len(M))
    before = up_to[border] - up_to[np.maximum(border - reach, 0)]
    behind = up_to[np.minimum(border + reach, len(M))] - up_to[border]
    growth: Floats = np.maximum(costs(before + behind) - costs(before) - costs(behind), 0.0)
    return growth
