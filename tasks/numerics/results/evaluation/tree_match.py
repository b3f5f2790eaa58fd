"""Edit distance between two trees whose joints are matched: how many joints must be removed and inserted.

A joint divides the body in two. Two trees are equal if every joint separates the same pairs of other joints. An edit removes a
joint, which joins two parts, or inserts one; a joint can only be equal to its partner in the matching. So a trunk in two parts
instead of one costs a single edit, where distances that keep separate branches separate count several.
"""

import itertools
from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Ints
from kinetree.tasks.numerics.results.evaluation.settings import EvaluationSettings


def tree_match_distance(
    parents: Sequence[int],
    others: Sequence[int],
    pairs: Sequence[tuple[int, int]],
    place: Sequence[int],
    settings: EvaluationSettings | None = None,
) -> int:
    """Number of joints to remove and to insert until the first tree is the second (ours).

    Where the trees contradict each other, pairs are given up greedily, the pair with most contradictions first. Joints at one
    place are paired so that there are fewest contradictions.

    parents  : (joint,) parent of every joint of the first tree, −1 for the root; a root is no joint between parts
    others   : (joint,) the same of the second tree
    pairs    : matched joints (of the first tree, of the second tree), without roots
    place    : (joint of the second tree,) equal numbers for joints at one place
    settings : most_permuted is used
    """
    one, two = separations(parents), separations(others)
    remaining = _best_pairs(one, two, list(pairs), place, (settings or EvaluationSettings()).most_permuted)
    while remaining:
        wrong = contradictions(one, two, remaining, place)
        if not wrong.any():
            break
        remaining.pop(int(wrong.argmax()))
    joints = sum(p >= 0 for p in parents) + sum(p >= 0 for p in others)
    return joints - 2 * len(remaining)


def separations(parents: Sequence[int]) -> Flags:
    """Which joints separate which pairs of other joints.

    parents : (joint,) parent of every joint, −1 for the root
    returns : (a, b, c) whether joint b lies between joints a and c, both different from b; a root separates nothing
    """
    n = len(parents)
    beyond = np.zeros((n, n), dtype=bool)
    for j in range(n):
        above = j
        while above >= 0:
            beyond[above, j] = True
            above = parents[above]
    between: Flags = beyond.T[:, :, None] != beyond[None]
    joint = np.array([p >= 0 for p in parents])
    other = ~np.eye(n, dtype=bool)
    return between & joint[None, :, None] & other[:, :, None] & other[None]


def contradictions(one: Flags, two: Flags, pairs: Sequence[tuple[int, int]], place: Sequence[int]) -> Ints:
    """Number of triples of pairs at three different places in which the trees contradict each other, for every pair.

    one, two : (a, b, c) as `separations` gives them, of the first and of the second tree
    pairs    : matched joints (of the first tree, of the second tree); at least one
    place    : (joint of the second tree,) equal numbers for joints at one place
    returns  : (pair,) triples that contain the pair
    """
    i, j = (np.array(side, dtype=np.int64) for side in zip(*pairs, strict=True))
    where = np.asarray(place)[j]
    apart = where[:, None] != where[None]
    wrong = one[np.ix_(i, i, i)] != two[np.ix_(j, j, j)]
    wrong &= apart[:, :, None] & apart[None] & apart[:, None, :]
    count: Ints = wrong.sum(axis=(1, 2)) + wrong.sum(axis=(0, 2)) + wrong.sum(axis=(0, 1))
    return count


def _best_pairs(
    one: Flags, two: Flags, pairs: list[tuple[int, int]], place: Sequence[int], most_permuted: int
) -> list[tuple[int, int]]:
    """The pairs, with partners at one place exchanged where this leaves fewer contradictions."""
    for where in sorted({place[j] for _, j in pairs}):
        at_place = [k for k, (_, j) in enumerate(pairs) if place[j] == where]
        if not 1 < len(at_place) <= most_permuted:
            continue
        options = []
        for order in itertools.permutations([pairs[k][1] for k in at_place]):
            exchanged = list(pairs)
            for k, j in zip(at_place, order, strict=True):
                exchanged[k] = (pairs[k][0], j)
            options.append(exchanged)
        pairs = min(options, key=lambda option: int(contradictions(one, two, option, place).sum()))
    return pairs
