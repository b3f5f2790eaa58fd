"""The order in which frames are reached from the reference: outwards in both directions (ours).

Frames that the body is learned from are reached from such frames alone, so that no other frame can change their poses. Each
other frame is reached from the frame beside it on the reference's side, whatever that is.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Ints


def takes_order(learned: Flags, takes: Sequence[slice], roots: Mapping[int, int]) -> Ints:
    """The position from which each frame is reached, in several takes.

    learned : (frame,) whether the body is learned from it
    takes   : positions of the frames of each take
    roots   : position of the frame of each take that is reached first, with that from which; −1 for the reference
    returns : (frame,)
    """
    before = np.empty(len(learned), dtype=np.int64)
    for span in takes:
        root = next(t for t in roots if span.start <= t < span.stop)
        own = tracking_order(learned[span], root - span.start)
        before[span] = np.where(own >= 0, own + span.start, roots[root])
    return before


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
