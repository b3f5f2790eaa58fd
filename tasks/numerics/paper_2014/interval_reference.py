"""Which frame of an interval is its reference (2014, Sec. 5.3)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags


def middle_frame(is_seen: Flags) -> int:
    """The frame at the middle of an interval, or the one nearest to it of those that see the most of its leaves.

    The paper takes the middle (Sec. 5.3), and every leaf is seen in every frame; the second half of the rule is ours.

    is_seen    : (leaf, frame) whether the frame sees the leaf
    returns : position of the frame in the interval; of two as near to the middle, the earlier
    """
    count = is_seen.sum(axis=0)
    distance = np.abs(np.arange(len(count)) - (len(count) - 1) / 2.0)
    return int(np.lexsort((distance, -count))[0])
