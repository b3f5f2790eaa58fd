"""Which limb of a body is which: people and four-legged animals, their front and their sides (ours).

The roles of limbs are those that fit best; where none fit, a second look leaves out ears, horns and tusks. Front is told by
toes, knees, elbows and travel, each a vote between −1 and 1; sides follow from front and up.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.limb_motion import Motion, across_pair, along_trunk, horizontal, in_rest, middle
from kinetree.tasks.numerics.structure.limb_roles import AnatomySettings, Pair, Roles, Topology, best_roles, horn_pairs
from kinetree.tasks.numerics.structure.limbs import Limb, limbs


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


def anatomy(body: Motion, front: Floats | None = None, settings: AnatomySettings | None = None) -> Anatomy | None:
    """Recognises a person or a four-legged animal; None where the tree is neither  (ours).

    front : (xyz,) direction that the body faces in the reference pose, where somebody knows it
    """
    s = settings or AnatomySettings()
    found = limbs(body.rest, body.parents)
    best, ears = best_roles(body, found, s), list[Pair]()
    if best is None and (ears := horn_pairs(body, found, s)):
        left_out = {limb.joints[0] for pair in ears for limb in pair}
        best = best_roles(body, limbs(body.rest, body.parents, without=left_out), s)
    if best is None:
        return None
    confidence = 1.0 - best.penalty / s.limit
    if best.topology == "human":
        return _human_sides(body, best, front, confidence, s)
    return _quadruped_sides(body, best, ears, front, confidence, s)


def _human_sides(body: Motion, roles: Roles, front: Floats | None, confidence: float, s: AnatomySettings) -> Anatomy:
    """Sides of a person: of two directions across the line between the hips, front is the one that most speaks for."""
    legs, arms = roles.legs, roles.arms
    pelvis = legs[0].base
    across = [in_rest(body, pelvis, across_pair(body, *pair)) for pair in (legs, arms)]
    if across[0] @ across[1] < 0.0:
        arms, across[1] = (arms[1], arms[0]), -across[1]
    trunk = in_rest(body, pelvis, along_trunk(body, legs, arms))
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
    return Anatomy("human", (legs, arms), head, None, horizontal(ahead, body.up), confidence, certainty)


def _quadruped_sides(
    body: Motion, roles: Roles, ears: list[Pair], front: Floats | None, confidence: float, s: AnatomySettings
) -> Anatomy:
    """Front and sides of an animal: of the two ends of the trunk, the front is the one that most speaks for.

    ears : pairs of ears, horns or tusks, which are at the front
    """
    hind, fore = roles.legs, roles.arms
    base = hind[0].base
    ahead = horizontal(in_rest(body, base, middle(body, fore) - middle(body, hind)), body.up)
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
        across = across_pair(body, a, b)
        sided.append((a, b) if in_rest(body, base, across) @ left >= 0.0 else (b, a))
    head = next((limb for limb, x in near if x < 0.0), None)
    tail = next((limb for limb, x in near if x >= 0.0), None)
    return Anatomy("quadruped", (sided[0], sided[1]), head, tail, ahead, confidence, certainty)


def _nearer(body: Motion, joint: int, fore: Pair, hind: Pair) -> float:
    """How much nearer a joint is to the one pair than to the other, mesh unit; negative where it is nearer to the first."""
    there = [np.linalg.norm(middle(body, pair) - body.X[:, joint], axis=1) for pair in (fore, hind)]
    return float(np.mean(there[0] - there[1]))


def _votes(body: Motion, legs: tuple[Limb, ...], base: int, ahead: Floats, knees: float, s: AnatomySettings) -> list[float]:
    """What speaks for a direction as the front: toes, travel, and the bend of the knees with a weight."""
    votes = []
    for leg in legs:
        last = next((j for j in leg.joints[1:] if len(leg.joints) > 2), None)
        if last is not None and np.linalg.norm(body.rest[last] - body.rest[leg.joints[0]]) < s.foot * leg.length:
            toes = in_rest(body, base, body.X[:, leg.joints[0]] - body.X[:, last])
            votes.append(2.0 / len(legs) * float(toes @ ahead) / max(float(np.linalg.norm(toes)), 1e-12))
    votes += [knees * vote for vote in _bends(body, legs, base, ahead, s)]
    way = np.diff(body.X[:, base], axis=0)
    travelled = float(in_rest(body, base, np.concatenate([way, way[-1:]]) if len(way) else np.zeros((1, 3))) @ ahead) * len(way)
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
            bent.append(in_rest(body, base, off - np.sum(off * line, axis=1, keepdims=True) * line))
        most = max(bent, key=lambda v: float(np.linalg.norm(v)))
        bends.append(float(np.clip(most @ ahead / (s.bend * limb.length), -1.0, 1.0)))
    return bends
