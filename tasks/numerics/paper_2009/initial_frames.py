"""The frame that an initial model is taken from, and the order in which it is deformed to others (2009, Sec. 2.3, 2.3.1)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints

FREE = 0.9
"""Branches so long, against the longest of any candidate, are those of free limbs. Chosen on a recorded wolf: two of its twenty
frames have more; the others, in which some legs touch, have 0.56 to 0.89."""


def initial_frame(similarity: Floats, candidate: Flags) -> int:
    """Position of the candidate most similar to all candidates together.

    similarity : (frame, frame) · candidate : (frame,) at least one
    """
    own = np.flatnonzero(candidate)
    return int(own[np.argmax(similarity[np.ix_(own, own)].sum(axis=1))])


def extended_frame(candidate: Flags, spread: Floats, length: Floats) -> int:
    """Position of the candidate whose ends are farthest apart, of those whose limbs are free (ours).

    Limbs that are stretched are drawn in full, where bent ones are drawn with their corners cut, and the surface of a bent
    hip or knee does not follow its nodes when they straighten. Legs that touch along their length are one branch that forks at
    the paws, without a loop and with all its ends: only the branches' lengths tell.

    candidate : (frame,) at least one
    spread    : (frame,) mean distance between the ends of a frame's graph
    length    : (frame,) of its branches, their geometric mean
    """
    free = np.flatnonzero(candidate & (length >= FREE * length[candidate].max()))
    return int(free[np.argmax(spread[free])])


def most_open_frames(count: Ints, loops: Ints) -> Flags:
    """(frame,) the frames with the fewest loops among those with the most ends, where no frame is coherent (ours)."""
    most = count == count.max()
    return np.asarray(most & (loops == loops[most].min()))


def reached_from(similarity: Floats, start: int, *, by_correlation: bool) -> Ints:
    """(frame,) position of the frame whose deformed model each frame starts from, −1 for the first.

    Frames are reached outwards in time; each starts from its neighbour, or from the frame reached before it that is most
    similar to it ("updating initial model based on correlation").

    similarity : (frame, frame) of the frames of one structure · start : position of the initial frame
    """
    at = np.arange(len(similarity))
    before: Ints = np.where(at == start, -1, at - np.sign(at - start))
    if by_correlation:
        order = np.argsort(np.abs(at - start), kind="stable")
        for n in range(1, len(order)):
            reached = order[:n]
            before[order[n]] = reached[np.argmax(similarity[order[n], reached])]
    return before
