"""The limbs of a tree of joints, whatever its root is: chains from an end to where the tree branches (ours)."""

from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


class LimbSettings(NamedTuple):
    """What counts as a limb."""

    short: float = 0.11
    """A chain shorter than this share of the longest way through the tree is an appendage, such as a thumb, a heel or an ear:
    those of people and dogs reach 0.08, heads begin at 0.14."""


class Limb(NamedTuple):
    """One limb.

    joints : its joints from the tip inwards, without that on which it hangs
    base   : the joint on which it hangs
    length : from the tip to the base along the bones, mesh unit
    """

    joints: tuple[int, ...]
    base: int
    length: float


def limbs(rest: Floats, parents: Ints, settings: LimbSettings | None = None, without: Collection[int] = ()) -> list[Limb]:
    """All limbs, the longest first; appendages are left out  (ours).

    At the end of a limb the longest appendage carries on the limb, such as the toes beside a heel.

    rest    : (joint, xyz) mesh unit
    parents : (joint,) −1 for the root
    without : ends that are left out
    """
    s = settings or LimbSettings()
    beside: list[set[int]] = [set() for _ in parents]
    for j, p in enumerate(parents.tolist()):
        if p >= 0 and j not in without:
            beside[j].add(p)
            beside[p].add(j)
    limit = s.short * max(float(ways(rest, parents, j).max()) for j in range(len(parents)))
    while True:
        found = _chains(rest, beside)
        for base in sorted({limb.base for limb in found}):
            here = sorted((limb for limb in found if limb.base == base and limb.length < limit), key=lambda x: x.length)
            spare = here if len(beside[base]) - len(here) >= 2 else here[:-1]
            if spare:
                for limb in spare:
                    beside[base].discard(limb.joints[-1])
                    for j in limb.joints:
                        beside[j].clear()
                break
        else:
            return sorted(found, key=lambda limb: (-limb.length, limb.joints))


def ways(rest: Floats, parents: Ints, start: int) -> Floats:
    """(joint,) the way along bones from one joint to every other, mesh unit."""
    length = np.linalg.norm(rest - rest[np.maximum(parents, 0)], axis=1)
    beside: list[list[tuple[int, float]]] = [[] for _ in parents]
    for j, p in enumerate(parents.tolist()):
        if p >= 0:
            beside[j].append((p, float(length[j])))
            beside[p].append((j, float(length[j])))
    way = np.full(len(parents), np.inf)
    way[start] = 0.0
    waiting = [start]
    while waiting:
        j = waiting.pop()
        for other, step in beside[j]:
            if way[other] == np.inf:
                way[other] = way[j] + step
                waiting.append(other)
    return way


def _chains(rest: Floats, beside: list[set[int]]) -> list[Limb]:
    """Every chain from an end to the first joint at which the tree branches; none where it does not."""
    found = []
    for tip in [j for j, others in enumerate(beside) if len(others) == 1]:
        chain, length, at = [tip], 0.0, tip
        while True:
            ahead = [o for o in sorted(beside[at]) if o not in chain]
            if not ahead:
                break  # a tree without branches
            length += float(np.linalg.norm(rest[ahead[0]] - rest[at]))
            at = ahead[0]
            if len(beside[at]) > 2:
                found.append(Limb(tuple(chain), at, length))
                break
            chain.append(at)
    return found
