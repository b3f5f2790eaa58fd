"""Which limb of a body is which: people and four-legged animals, their front and their sides (ours).

A hypothesis gives limbs the roles of legs, arms, head and tail. It is judged by what hardly depends on the pose: equal lengths
of the two of a pair, where limbs hang on the trunk, how high their ends are over the sequence. The best one counts if it is
good enough; where none is, a second look leaves out ears, horns and tusks. Front is told by toes, knees, elbows and travel,
each a vote between −1 and 1; sides follow from front and up.
"""

from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Literal, NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.limbs import Limb, limbs, ways

Topology = Literal["human", "quadruped"]


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


class Motion(NamedTuple):
    """A skeleton over time.

    rest     : (joint, xyz) in the reference pose, mesh unit
    parents  : (joint,) −1 for the root, parents first
    X        : (frame, joint, xyz) mesh unit
    R        : (frame, joint, row, xyz) from the reference pose to each frame
    up       : (xyz,) unit vector
    """

    rest: Floats
    parents: Ints
    X: Floats
    R: Floats
    up: Floats


class Anatomy(NamedTuple):
    """Which limb is which.

    topology   : of the body
    pairs      : (left, right) hind legs or legs, then fore legs or arms
    head, tail : None where they are no limbs
    front      : (xyz,) horizontal unit vector in the reference pose
    confidence : of the roles, 0 to 1
    certainty  : of the front and so of the sides, 0 to 1
    """

    topology: Topology
    pairs: tuple[tuple[Limb, Limb], tuple[Limb, Limb]]
    head: Limb | None
    tail: Limb | None
    front: Floats
    confidence: float
    certainty: float


Pair = tuple[Limb, Limb]
APART = 0.05
"""Distance of two innermost joints from which on they say where left is, share of the length of both limbs."""


class _Roles(NamedTuple):
    topology: Topology
    legs: Pair
    arms: Pair
    ends: tuple[Limb, ...]
    penalty: float


def anatomy(body: Motion, front: Floats | None = None, settings: AnatomySettings | None = None) -> Anatomy | None:
    """Recognises a person or a four-legged animal; None where the tree is neither  (ours).

    front : (xyz,) direction that the body faces in the reference pose, where somebody knows it
    """
    s = settings or AnatomySettings()
    found = limbs(body.rest, body.parents)
    best, ears = _best(body, found, s), list[Pair]()
    if best is None and (ears := _ears(body, found, s)):
        left_out = {limb.joints[0] for pair in ears for limb in pair}
        best = _best(body, limbs(body.rest, body.parents, without=left_out), s)
    if best is None:
        return None
    confidence = 1.0 - best.penalty / s.limit
    if best.topology == "human":
        return _human_sides(body, best, front, confidence, s)
    return _quadruped_sides(body, best, ears, front, confidence, s)


def _best(body: Motion, found: list[Limb], s: AnatomySettings) -> _Roles | None:
    """The roles that fit the limbs best; None where none fit."""
    best = min(_hypotheses(body, found[: s.most_limbs], s), key=lambda roles: roles.penalty, default=None)
    return None if best is None or best.penalty >= s.limit else best


def _ears(body: Motion, found: list[Limb], s: AnatomySettings) -> list[Pair]:
    """Pairs of ends that may be ears, horns or tusks: of like length, high up, turning with the joint they hang on."""
    tall = zip(found, _heights(body, found).tolist(), strict=True)
    bare = [limb for limb, height in tall if len(limb.joints) == 1 and height > s.ear_height]
    return [
        (a, b)
        for a, b in combinations(bare, 2)
        if a.base == b.base and abs(a.length - b.length) < s.ear_likeness * (a.length + b.length) / 2.0
    ]


def _hypotheses(body: Motion, found: list[Limb], s: AnatomySettings) -> Iterator[_Roles]:
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
                yield _Roles("human", legs, arms, () if head is None else (head,), penalty)
            if found.index(legs[0]) > found.index(arms[0]):
                continue  # which of the pairs is in front is decided later
            feet = [height[x] for x in (*legs, *arms)]
            level = common + 3.0 * float(np.mean(feet)) + 4.0 * max(0.0, max(feet) - s.foot_height)
            level += 1.5 * _slope(body, legs, arms)
            for ends in [pair for count in range(3) for pair in combinations(others, count)]:
                left = [limb for limb in others if limb not in ends]
                yield _Roles("quadruped", legs, arms, ends, level + _spare(left, found, s) + 0.1 * (2 - len(ends)))


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
    steep = 1.5 * (1.0 - max(0.0, float(np.mean(_trunk(body, legs, arms) @ body.up))))
    longer = max(0.0, sum(a.length for a in arms) / sum(a.length for a in legs) - 1.0)
    return low + steep + longer


def _head(body: Motion, head: Limb, arms: tuple[Limb, ...], height: float) -> float:
    """Penalty of a limb as the head of a person: it is high up, hangs where the arms hang and is short."""
    mean = sum(arm.length for arm in arms) / 2.0
    away = min(float(ways(body.rest, body.parents, head.base)[arm.base]) for arm in arms) / mean
    return 2.0 * (1.0 - height) + away + max(0.0, head.length / mean - 1.0)


def _slope(body: Motion, legs: Pair, arms: Pair) -> float:
    """How steep the trunk is: 0 where it is level, 1 where it stands."""
    return float(np.mean(np.abs(_trunk(body, legs, arms) @ body.up)))


def _trunk(body: Motion, legs: tuple[Limb, ...], arms: tuple[Limb, ...]) -> Floats:
    """(frame, xyz) unit vectors from where the legs hang to where the arms hang."""
    along = _middle(body, arms) - _middle(body, legs)
    return np.asarray(along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12))


def _middle(body: Motion, pair: tuple[Limb, ...]) -> Floats:
    """(frame, xyz) middle of the innermost joints of a pair."""
    return np.asarray(np.mean([body.X[:, limb.joints[-1]] for limb in pair], axis=0))


def _in_rest(body: Motion, joint: int, vectors: Floats) -> Floats:
    """(xyz,) mean over the frames of vectors (frame, xyz) turned back to the reference pose with the part of a joint."""
    return np.asarray(np.mean(np.einsum("tyx,ty->tx", body.R[:, joint], vectors), axis=0))


def _human_sides(body: Motion, roles: _Roles, front: Floats | None, confidence: float, s: AnatomySettings) -> Anatomy:
    """Sides of a person: of two directions across the line between the hips, front is the one that most speaks for."""
    legs, arms = roles.legs, roles.arms
    pelvis = legs[0].base
    across = [_in_rest(body, pelvis, _across(body, *pair)) for pair in (legs, arms)]
    if across[0] @ across[1] < 0.0:
        arms, across[1] = (arms[1], arms[0]), -across[1]
    trunk = _in_rest(body, pelvis, _trunk(body, legs, arms))
    ahead = np.cross(across[0], trunk)  # the front, if the first leg is the left one
    ahead /= max(float(np.linalg.norm(ahead)), 1e-12)
    votes = _votes(body, legs, pelvis, ahead, 1.0, s) + [-0.5 * v for v in _bends(body, arms, pelvis, ahead, s)]
    certainty = float(np.clip(abs(sum(votes)), 0.0, 1.0))
    forwards = sum(votes) >= 0.0
    if front is not None:
        forwards, certainty = bool(front @ ahead >= 0.0), 1.0
    if not forwards:
        ahead, legs, arms = -ahead, (legs[1], legs[0]), (arms[1], arms[0])
    head = roles.ends[0] if roles.ends else None
    return Anatomy("human", (legs, arms), head, None, _level(ahead, body.up), confidence, certainty)


def _quadruped_sides(
    body: Motion, roles: _Roles, ears: list[Pair], front: Floats | None, confidence: float, s: AnatomySettings
) -> Anatomy:
    """Front and sides of an animal: of the two ends of the trunk, the front is the one that most speaks for.

    ears : pairs of ears, horns or tusks, which are at the front
    """
    hind, fore = roles.legs, roles.arms
    base = hind[0].base
    ahead = _level(_in_rest(body, base, _middle(body, fore) - _middle(body, hind)), body.up)
    votes = _votes(body, (*hind, *fore), base, ahead, 0.0, s)
    near = [(limb, _nearer(body, limb.base, fore, hind)) for limb in roles.ends]
    votes += [-float(np.sign(_nearer(body, pair[0].base, fore, hind))) for pair in ears]
    before = min(near, key=lambda pair: pair[1], default=None)
    behind = max(near, key=lambda pair: pair[1], default=None)
    if before and behind and before[0] is not behind[0]:
        rise = [float(np.mean((body.X[:, limb.joints[0]] - body.X[:, limb.base]) @ body.up)) for limb in (before[0], behind[0])]
        votes.append(0.5 * float(np.clip((rise[0] - rise[1]) / hind[0].length / 0.5, -1.0, 1.0)))
    certainty = float(np.clip(abs(sum(votes)), 0.0, 1.0))
    forwards = sum(votes) >= 0.0
    if front is not None:
        forwards, certainty = bool(front @ ahead >= 0.0), 1.0
    if not forwards:
        hind, fore, ahead, near = fore, hind, -ahead, [(limb, -x) for limb, x in near]
    left = np.cross(body.up, ahead)
    sided = []
    for a, b in (hind, fore):
        across = _across(body, a, b)
        sided.append((a, b) if _in_rest(body, base, across) @ left >= 0.0 else (b, a))
    head = next((limb for limb, x in near if x < 0.0), None)
    tail = next((limb for limb, x in near if x >= 0.0), None)
    return Anatomy("quadruped", (sided[0], sided[1]), head, tail, ahead, confidence, certainty)


def _nearer(body: Motion, joint: int, fore: Pair, hind: Pair) -> float:
    """How much nearer a joint is to the one pair than to the other, mesh unit; negative where it is nearer to the first."""
    there = [np.linalg.norm(_middle(body, pair) - body.X[:, joint], axis=1) for pair in (fore, hind)]
    return float(np.mean(there[0] - there[1]))


def _across(body: Motion, a: Limb, b: Limb) -> Floats:
    """(frame, xyz) from the second limb of a pair to the first, between their innermost joints.

    Where those lie in one place, the next ones count too.
    """
    apart = [body.X[:, a.joints[k]] - body.X[:, b.joints[k]] for k in range(-min(2, len(a.joints), len(b.joints)), 0)]
    is_wide = float(np.linalg.norm(apart[-1], axis=1).mean()) > APART * (a.length + b.length)
    return np.asarray(apart[-1] if is_wide else np.mean(apart, axis=0))


def _votes(body: Motion, legs: tuple[Limb, ...], base: int, ahead: Floats, knees: float, s: AnatomySettings) -> list[float]:
    """What speaks for a direction as the front: toes, travel, and the bend of the knees with a weight."""
    votes = []
    for leg in legs:
        last = next((j for j in leg.joints[1:] if len(leg.joints) > 2), None)
        if last is not None and np.linalg.norm(body.rest[last] - body.rest[leg.joints[0]]) < s.foot * leg.length:
            toes = _in_rest(body, base, body.X[:, leg.joints[0]] - body.X[:, last])
            votes.append(2.0 / len(legs) * float(toes @ ahead) / max(float(np.linalg.norm(toes)), 1e-12))
    votes += [knees * vote for vote in _bends(body, legs, base, ahead, s)]
    way = np.diff(body.X[:, base], axis=0)
    travelled = float(_in_rest(body, base, np.concatenate([way, way[-1:]]) if len(way) else np.zeros((1, 3))) @ ahead) * len(
        way
    )
    return [*votes, float(np.clip(travelled / (s.travel * legs[0].length), -1.0, 1.0))]


def _bends(body: Motion, pair: tuple[Limb, ...], base: int, ahead: Floats, s: AnatomySettings) -> list[float]:
    """For each limb with three joints how far the middle one lies off the line of the others towards a direction, −1 to 1."""
    bends = []
    for limb in [limb for limb in pair if len(limb.joints) > 3]:
        inner, outer = body.X[:, limb.joints[-1]], body.X[:, limb.joints[1]]
        line = (outer - inner) / np.maximum(np.linalg.norm(outer - inner, axis=1, keepdims=True), 1e-12)
        bent = []
        for j in limb.joints[2:-1]:
            off = body.X[:, j] - inner
            bent.append(_in_rest(body, base, off - np.sum(off * line, axis=1, keepdims=True) * line))
        most = max(bent, key=lambda v: float(np.linalg.norm(v)))
        bends.append(float(np.clip(most @ ahead / (s.bend * limb.length), -1.0, 1.0)))
    return bends


def _level(v: Floats, up: Floats) -> Floats:
    """The horizontal part of a vector, of length 1; the vector itself where it has none."""
    flat = v - (v @ up) * up
    length = float(np.linalg.norm(flat))
    return np.asarray(flat / length if length > 1e-9 else v)
