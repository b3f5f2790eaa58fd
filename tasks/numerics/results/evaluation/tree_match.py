"""How many joints stand between two trees whose joints are known to be the same or not.

A joint divides the body in two; a tree is what each of its joints divides from what. Two trees are the same if every joint
separates the same pairs of others. Edits are to remove a joint, which makes one part of two, and to put one in; a joint may
only become the one that it was matched with. So a trunk that is in two parts where it should be one costs a single edit, which
distances that keep separate branches separate count as many.
"""

import itertools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]
SAME_PLACE = 5
"""Joints at one place up to which every way of pairing them is tried."""


def tree_match_distance(
    parents: Sequence[int], others: Sequence[int], pairs: Sequence[tuple[int, int]], place: Sequence[int]
) -> int:
    """Joints to remove and to put in until the first tree is the second.

    The pairs that have to be given up because the trees contradict each other there are found greedily, those in most
    contradictions first; joints at one place are paired as contradicts least.

    parents, others : (joint,) parent of every joint in either tree, −1 for the root; a root is no joint between parts
    pairs           : joints of the first and of the second tree that are the same, roots left out
    place           : (joint of the second,) equal for joints that lie at one and the same place
    """
    one, two = separations(parents), separations(others)
    left = _best_pairs(one, two, list(pairs), place)
    kept = len(left)
    while left:
        wrong = contradictions(one, two, left, place)
        if not wrong.any():
            break
        left.pop(int(wrong.argmax()))
    joints = sum(p >= 0 for p in parents) + sum(p >= 0 for p in others)
    return joints - 2 * min(kept, len(left))


def separations(parents: Sequence[int]) -> Bools:
    """(a, b, c) whether joint b lies between joints a and c, which are others than b; a root separates nothing.

    parents : (joint,) −1 for the root
    """
    n = len(parents)
    beyond = np.zeros((n, n), dtype=bool)
    for j in range(n):
        above = j
        while above >= 0:
            beyond[above, j] = True
            above = parents[above]
    between: Bools = beyond.T[:, :, None] != beyond[None]
    joint = np.array([p >= 0 for p in parents])
    other = ~np.eye(n, dtype=bool)
    return between & joint[None, :, None] & other[:, :, None] & other[None]


def contradictions(one: Bools, two: Bools, pairs: Sequence[tuple[int, int]], place: Sequence[int]) -> Ints:
    """(pair,) in how many triples of pairs, all at different places, that say different things each pair is."""
    i, j = (np.array(side, dtype=np.int64) for side in zip(*pairs, strict=True))
    where = np.asarray(place)[j]
    apart = where[:, None] != where[None]
    wrong = one[np.ix_(i, i, i)] != two[np.ix_(j, j, j)]
    wrong &= apart[:, :, None] & apart[None] & apart[:, None, :]
    count: Ints = wrong.sum(axis=(1, 2)) + wrong.sum(axis=(0, 2)) + wrong.sum(axis=(0, 1))
    return count


def _best_pairs(one: Bools, two: Bools, pairs: list[tuple[int, int]], place: Sequence[int]) -> list[tuple[int, int]]:
    """The pairs, those at one place exchanged where that leaves fewer contradictions."""
    for where in sorted({place[j] for _, j in pairs}):
        mine = [k for k, (_, j) in enumerate(pairs) if place[j] == where]
        if not 1 < len(mine) <= SAME_PLACE:
            continue
        options = []
        for order in itertools.permutations([pairs[k][1] for k in mine]):
            tried = list(pairs)
            for k, j in zip(mine, order, strict=True):
                tried[k] = (pairs[k][0], j)
            options.append(tried)
        pairs = min(options, key=lambda tried: int(contradictions(one, two, tried, place).sum()))
    return pairs
