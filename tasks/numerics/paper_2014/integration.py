"""Non-rigid labels shared by all intervals, and the threshold with the most clusters (2014, Sec. 6.1.3; Figs. 11 and 12)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Ints


def integrated(annulus: list[Ints], rigid: list[Flags], annuli: int) -> Flags:
    """(annulus,) whether annulus k of a cone is rigid: not if it is non-rigid in any interval (Sec. 6.1.3; Fig. 12).

    annulus, rigid : of each interval, (own annulus,) the annuli that it has · whether they are rigid there
    annuli         : length of the result; an annulus that no interval has is rigid
    """
    out = np.ones(annuli, dtype=bool)
    for k, r in zip(annulus, rigid, strict=True):
        out[k[~r]] = False
    return out


def rigid_areas(rigid: Flags) -> int:
    """How many runs of rigid annuli there are along one cone.

    rigid : (annulus,)
    """
    return int(rigid[:1].sum() + (rigid[1:] & ~rigid[:-1]).sum())


def most_clusters(count: Ints) -> int:
    """The threshold with the most clusters (caption of Fig. 11); of equally many the lowest (ours).

    An annulus across a joint is not rigid itself, and its own error hides in Eq. 11 that it does not follow the cluster
    before it: under a high threshold it joins, and the annulus behind it is taken for the joint.

    count   : (threshold,) clusters that each gives, by ascending threshold
    returns : position of the threshold
    """
    return int(np.argmax(count))
