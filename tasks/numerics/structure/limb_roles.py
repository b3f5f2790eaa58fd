"""Which limbs of a body may be legs, arms, head and tail: hypotheses and their penalties (ours).

A hypothesis is judged by what hardly depends on the pose: equal lengths of the two of a pair, where limbs hang on the trunk,
how high their ends are over the sequence. The best one counts if it is good enough.
"""

from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Literal, NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.limb_motion import Motion, along_trunk
from kinetree.tasks.numerics.structure.limbs import Limb, ways

Topology = Literal["human", "quadruped"]
Pair = tuple[Limb, Limb]


class AnatomySettings(NamedTuple):
    """What makes a tree a person or an animal. Chosen on generated humans and dogs, whose penalties are 0.06 to 0.5 where
    those of all other roles and of other bodies are above 1.1; weights are of the order of one for what no such body has.
    """

    limit: float = 1.0
    """Penalty from which on a hypothesis is refused."""
    most_limbs: int = 8
    """Limbs that are given roles, the longest of a tree."""
    arm_height: float = 0.3
    """Least mean height of a person's hands, share of the body's height."""
    unassigned: float = 2.0
    """Penalty of a limb without a role, times its share of the longest one."""
    no_head: float = 0.4
    """Penalty of a person whose head is no limb."""
    foot_height: float = 0.2
    """Mean height above which an end is hardly a foot of an animal, share of the body's height; tails end at 0.3 and more."""
    ear_height: float = 0.3
    """Least mean height of the ends of ears, horns and tusks, share of the body's height: those of legs are below 0.15."""
    ear_likeness: float = 0.2
    """Most that the two of such a pair differ in length, share of their mean."""
    foot: float = 0.22
    """Share of a leg's length from its end within which the last joint lies that is taken for the ankle."""
    bend: float = 0.06
    """Bend of a knee or elbow at which its vote is full, share of the limb's length."""
    travel: float = 0.5
    """Way travelled at which its vote is full, share of the length of a leg."""


class Roles(NamedTuple):
    topology: Topology
    legs: Pair
    arms: Pair
    ends: tuple[Limb, ...]
    penalty: float


def best_roles(body: Motion, found: list[Limb], s: AnatomySettings) -> Roles | None:
    """The roles that fit the limbs best; None where none fit."""
    best = min(_hypotheses(body, found[: s.most_limbs], s), key=lambda roles: roles.penalty, default=None)
    return None if best is None or best.penalty >= s.limit else best


def horn_pairs(body: Motion, found: list[Limb], s: AnatomySettings) -> list[Pair]:
    """Pairs of ends that may be ears, horns or tusks: of like length, high up, turning with the joint they hang on."""
    tall = zip(found, _heights(body, found).tolist(), strict=True)
    bare = [limb for limb, height in tall if len(limb.joints) == 1 and height > s.ear_height]
    return [
        (a, b)
        for a, b in combinations(bare, 2)
        if a.base == b.base and abs(a.length - b.length) < s.ear_likeness * (a.length + b.length) / 2.0
    ]


def _hypotheses(body: Motion, found: list[Limb], s: AnatomySettings) -> Iterator[Roles]:
    """All ways of giving two pairs, a head and a tail, with their penalties."""
    height = dict(zip(found, _heights(body, found).tolist(), strict=True))
    for legs in combinations(found, 2):
        for arms in combinations([limb for limb in found if limb not in legs], 2):
            others = [limb for limb in found if limb not in (*legs, *arms)]
            common = _unlike(body, *legs) + _unlike(body, *arms)
            upright = common + _human(body, legs, arms, height, s)
            for head in [None, *others]:
                left = [limb for limb in others if limb is not head]
                penalty = upright + _spare(left, found, s)
                penalty += s.no_head if head is None else _head(body, head, arms, height[head])
                yield Roles("human", legs, arms, () if head is None else (head,), penalty)
            if found.index(legs[0]) > found.index(arms[0]):
                continue  # which of the pairs is in front is decided later
            feet = [height[x] for x in (*legs, *arms)]
            level = common + 3.0 * float(np.mean(feet)) + 4.0 * max(0.0, max(feet) - s.foot_height)
            level += 1.5 * _slope(body, legs, arms)
            for ends in [pair for count in range(3) for pair in combinations(others, count)]:
                left = [limb for limb in others if limb not in ends]
                yield Roles("quadruped", legs, arms, ends, level + _spare(left, found, s) + 0.1 * (2 - len(ends)))


def _heights(body: Motion, found: list[Limb]) -> Floats:
    """(limb,) mean height of every limb's tip over the frames, share of the body's height in each."""
    h = body.X @ body.up
    low, high = h.min(axis=1), h.max(axis=1)
    tips = [limb.joints[0] for limb in found]
    return np.asarray(np.mean((h[:, tips] - low[:, None]) / np.maximum(high - low, 1e-12)[:, None], axis=0))


def _unlike(body: Motion, a: Limb, b: Limb) -> float:
    """How little two limbs look like a pair: lengths, and the way between the joints on which they hang."""
    mean = (a.length + b.length) / 2.0
    return 2.0 * abs(a.length - b.length) / mean + float(ways(body.rest, body.parents, a.base)[b.base]) / mean


def _spare(left: list[Limb], found: list[Limb], s: AnatomySettings) -> float:
    """Penalty of limbs without a role."""
    return s.unassigned * sum(limb.length for limb in left) / found[0].length


def _human(body: Motion, legs: Pair, arms: Pair, height: Mapping[Limb, float], s: AnatomySettings) -> float:
    """Penalty of two pairs as legs and arms of a person: feet low, hands off the ground, arms above the legs, legs longer."""
    feet, hands = (float(np.mean([height[limb] for limb in pair])) for pair in (legs, arms))
    low = 2.0 * feet + 3.0 * max(0.0, s.arm_height - hands)
    steep = 1.5 * (1.0 - max(0.0, float(np.mean(along_trunk(body, legs, arms) @ body.up))))
    longer = max(0.0, sum(a.length for a in arms) / sum(a.length for a in legs) - 1.0)
    return low + steep + longer


def _head(body: Motion, head: Limb, arms: tuple[Limb, ...], height: float) -> float:
    """Penalty of a limb as the head of a person: it is high up, hangs where the arms hang and is short."""
    mean = sum(arm.length for arm in arms) / 2.0
    away = min(float(ways(body.rest, body.parents, head.base)[arm.base]) for arm in arms) / mean
    return 2.0 * (1.0 - height) + away + max(0.0, head.length / mean - 1.0)


def _slope(body: Motion, legs: Pair, arms: Pair) -> float:
    """How steep the trunk is: 0 where it is level, 1 where it stands."""
    return float(np.mean(np.abs(along_trunk(body, legs, arms) @ body.up)))
