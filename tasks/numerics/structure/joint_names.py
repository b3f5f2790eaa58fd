"""Readable names for the joints of a tree, the same on every run and under small changes of the body.

`root`; `spine_1`, `spine_2` … for joints beyond which the body branches; `limb_a_1`, `limb_a_2` … along a limb, which does not
branch; `…_end` for ends of bones. Limbs are lettered from the root outwards in an order of lengths and places,
decided at the widest gap of any of them, then again within both halves: so two limbs change letters only if the largest
difference between them goes.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints


class JointNames(NamedTuple):
    """An order of joints, parents before children, branch by branch, and their names.

    order : (joint,) the given joint at each place, names : of each place
    """

    order: Ints
    names: tuple[str, ...]


def joint_names(rest: Floats, parents: Ints, ends: Flags) -> JointNames:
    """Orders and names all joints (ours).

    rest    : (joint, xyz) in the reference, parents : (joint,) −1 for the root, which is the first
    ends    : (joint,) whether it is the end of a bone
    """
    children = [np.flatnonzero(parents == j) for j in range(len(parents))]
    length, tip, branching = _outwards(rest, parents, ends)
    order: list[int] = []
    name: dict[int, str] = {}
    spines, limbs = 0, 0
    waiting = [0]
    while waiting:
        j = waiting.pop()
        order.append(j)
        turning = [int(c) for c in children[j] if not ends[c]]
        if j == 0:
            name[j] = "root"
        elif ends[j]:
            beside = [int(c) for c in children[parents[j]] if ends[c]]
            stem = name[int(parents[j])]
            if stem.startswith("limb") and len(beside) == len(children[parents[j]]):
                stem = stem.rsplit("_", 1)[0]
            name[j] = f"{stem}_end" + (f"_{beside.index(j) + 1}" if len(beside) > 1 else "")
        elif branching[j]:
            spines += 1
            name[j] = f"spine_{spines}"
        elif name[int(parents[j])].startswith("limb"):
            stem, number = name[int(parents[j])].rsplit("_", 1)
            name[j] = f"{stem}_{int(number) + 1}"
        else:
            name[j] = f"limb_{_letters(limbs)}_1"
            limbs += 1
        features = np.concatenate([length[turning, None], rest[tip[turning]]], axis=1) if turning else np.zeros((0, 4))
        ranked = [turning[k] for k in widest_gaps(features)]
        ranked.sort(key=lambda c: not branching[c])
        waiting += [*reversed([*ranked, *(int(c) for c in children[j] if ends[c])])]
    return JointNames(np.array(order), tuple(name[j] for j in order))


def widest_gaps(features: Floats) -> list[int]:
    """Rows of (row, column) in an order decided at the widest gap of any column, then within both halves, the greater first."""
    rows = list(range(len(features)))
    if len(rows) < 2:
        return rows
    ranked = np.argsort(features, axis=0, kind="stable")
    gaps = np.diff(np.take_along_axis(features, ranked, axis=0), axis=0)
    at, column = np.unravel_index(int(np.argmax(gaps)), gaps.shape)
    low, high = ranked[: at + 1, column], ranked[at + 1 :, column]
    return [int(half[k]) for half in (high, low) for k in widest_gaps(features[half])]


def _outwards(rest: Floats, parents: Ints, ends: Flags) -> tuple[Floats, Ints, Flags]:
    """Per joint: the longest way along bones from its parent through it, where that leads, and whether joints branch beyond."""
    length, tip = np.zeros(len(parents)), np.arange(len(parents))
    branching = np.zeros(len(parents), dtype=bool)
    turning = np.zeros(len(parents), dtype=np.int64)
    for j in range(len(parents) - 1, 0, -1):
        p = int(parents[j])
        branching[j] |= turning[j] > 1
        length[j] += float(np.linalg.norm(rest[j] - rest[p]))
        if length[j] > length[p]:
            length[p], tip[p] = length[j], tip[j]
        turning[p] += not ends[j]
        branching[p] |= branching[j]
    return length, tip, branching


def _letters(number: int) -> str:
    """0 is a, 25 is z, 26 is aa."""
    text = ""
    number += 1
    while number:
        number, digit = divmod(number - 1, 26)
        text = chr(ord("a") + digit) + text
    return text
