"""The order in which frames are reached from the reference: outwards in both directions (ours).

Frames that the body is learned from are reached from such frames alone, so that no other frame can change their poses. Each
other frame is reached from the frame beside it on the reference's side, whatever that is.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Ints


def tracking_order(learned: Flags, reference: int) -> Ints:
    """The position from which each frame is reached.

    learned   : (frame,) whether the body is learned from it
    reference : position of the reference, which is learned from
    returns   : (frame,) −1 for the reference
    """
    at = np.arange(len(learned))
    towards = np.sign(reference - at)
    before = np.where(at == reference, -1, at + towards)
    for t in np.flatnonzero(learned):
        while before[t] >= 0 and not learned[before[t]]:
            before[t] += towards[t]
    return before
