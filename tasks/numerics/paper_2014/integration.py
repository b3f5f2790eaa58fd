"""Non-rigid labels shared by all intervals, and the threshold with the most clusters (2014, Sec. 6.1.3; Figs. 11 and 12)."""

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


def integrated(annulus: list[Ints], rigid: list[Bools], annuli: int) -> Bools:
    """(annulus,) whether annulus k of a cone is rigid: not if it is a joint in any interval; true where there is none.

    annulus, rigid : of each interval, (seen,) the annuli that it has, and whether they are rigid there
    """
    out = np.ones(annuli, dtype=bool)
    for k, r in zip(annulus, rigid, strict=True):
        out[k[~r]] = False
    return out


def rigid_areas(rigid: Bools) -> int:
    """How many runs of rigid annuli there are along one cone (annulus,)."""
    return int(rigid[:1].sum() + (rigid[1:] & ~rigid[:-1]).sum())


def most_clusters(count: Ints) -> int:
    """The threshold with the most clusters; of equally many the lowest, which finds a joint before its ring has passed.

    An annulus across a joint is not rigid itself, which hides in Eq. 11's ratio that it does not follow: a high threshold
    takes the annulus behind it for the joint.

    count : (rung,) clusters that each gives, by ascending threshold
    """
    return int(np.argmax(count))
