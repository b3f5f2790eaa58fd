"""Which parts are parts: a joint turns more than it drifts; what slides is cloth, flesh or an error of the alignment.

A part whose joint fails is dropped and its vertices go to the parts around it, never merged as a rigid whole: merging by a
bad border once made two parts of a body. Everything around is then found anew, and the worst is asked again.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from kinetree.tasks.numerics.rings import rings
from kinetree.tasks.numerics.structure.articulation import beyond
from kinetree.tasks.numerics.structure.handover import handed_over
from kinetree.tasks.numerics.structure.joints import SPREAD, Borders, Joints, blend_error, borders, rotation_centres
from kinetree.tasks.numerics.structure.tree import Tree, rooted, spanning

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

LEAST_RATIO = 0.6
"""What turning must move a part by, against what its joint drifts by."""
LEAST_DEGREES = 8.0
NOISE = 0.001
"""Drift that is none, share of the root of the area."""
SHORT = 0.1
"""How much a border costs for every time that another one of its parts is longer."""
POSES = 96


class Jointed(NamedTuple):
    """Parts, numbered without gaps, hung in a tree.

    label   : (vertex,) part, R, t : (frame, part, 3, 3), (frame, part, xyz) from the reference
    borders : where parts meet, joints : a centre for each
    tree    : of all parts
    degrees : (part,) range of turning against the parent, by place in the tree; 0 for the root
    ratio   : (part,) turning against drift, by place in the tree; infinite for the root
    """

    label: Ints
    R: Floats
    t: Floats
    borders: Borders
    joints: Joints
    tree: Tree
    degrees: Floats
    ratio: Floats


def jointed(
    V: Floats,
    F: Ints,
    x: Floats,
    area: Floats,
    label: Ints,
    R: Floats,
    t: Floats,
    residual: Floats,
    trust: Floats | None = None,
) -> Jointed:
    """The tree of all parts, without a look at which of them deserve to be parts.

    V, F, x  : (vertex, xyz) mesh unit · (face, corner) · (frame, vertex, xyz)
    area     : (vertex,) mesh unit²
    label    : (vertex,) part; R, t : their motion
    residual : (frame, part) what a part's motion leaves unexplained, mesh unit
    trust    : (frame, part) weight of each part in each frame; None believes all
    """
    count = R.shape[1]
    size = float(np.sqrt(area.sum()))
    met = _joined(V, borders(V, F, label), label, count, size)
    centres = rotation_centres(R, t, met.pair, met.centre, met.radius, residual, trust)
    longest = np.zeros(count)
    np.maximum.at(longest, met.pair.ravel(), np.repeat(met.length, 2))
    shortness = longest[met.pair].min(axis=1) / np.maximum(met.length, np.finfo(float).tiny)
    blend = blend_error(V, F, x, label, met.pair, R, t)
    away = np.linalg.norm(centres.rest - met.centre, axis=1) / (SPREAD * np.maximum(met.radius, np.finfo(float).tiny))
    cost = (centres.drift * np.hypot(1.0, away) + blend + NOISE * size) * (1.0 + SHORT * shortness)
    tree = rooted(met.pair, spanning(met.pair, cost, count), np.bincount(label, area, count).astype(np.float64))
    met = branch_borders(met, tree)
    centres = rotation_centres(R, t, met.pair, met.centre, met.radius, residual, trust)
    degrees, ratio = np.zeros(count), np.full(count, np.inf)
    for k in range(1, count):
        part, above, row = tree.order[k], tree.order[tree.parents[k]], tree.border[k]
        turns = np.einsum("txy,txz->tyz", R[:, above], R[:, part])
        degrees[k] = turning_range(turns)
        lever = min(_swing(V, area, label == p, centres.rest[row], turns, p == above) for p in (part, above))
        ratio[k] = lever / (centres.drift[row] + NOISE * size)
    return Jointed(label, R, t, met, centres, tree, degrees, ratio)


def branch_borders(met: Borders, tree: Tree) -> Borders:
    """The same borders; those of the tree have become the whole closed line around what hangs on them.

    A thigh that meets the other one has its hip in the middle of all that it meets, not of its border with the trunk alone.
    """
    count = len(tree.order)
    place = np.empty(count, dtype=np.int64)
    place[tree.order] = np.arange(count)
    below = beyond(tree.parents) > 0
    centre, radius = met.centre.copy(), met.radius.copy()
    for k in range(1, count):
        a, b = below[k, place[met.pair]].T
        w, c, r = met.length[a != b], met.centre[a != b], met.radius[a != b]
        middle = w @ c / w.sum()
        row = tree.border[k]
        centre[row], radius[row] = middle, np.sqrt(w @ (r**2 + ((c - middle) ** 2).sum(axis=1)) / w.sum())
    return met._replace(centre=centre, radius=radius)


def pruned(
    V: Floats,
    F: Ints,
    x: Floats,
    area: Floats,
    label: Ints,
    R: Floats,
    t: Floats,
    residual: Floats,
    trust: Floats | None = None,
    *,
    degrees: float = LEAST_DEGREES,
    ratio: float = LEAST_RATIO,
) -> Jointed:
    """The tree of those parts whose joints turn by enough and more than they drift; the smaller side of each other is dropped.

    Takes what `jointed` takes, and repeats it after every part that is dropped.

    degrees, ratio : what a joint must turn by, and how many times farther than it drifts
    """
    start, ring = rings(F, len(V))
    while True:
        found = jointed(V, F, x, area, label, R, t, residual, trust)
        merit = np.minimum(found.ratio / max(ratio, 1e-9), np.append(np.inf, found.degrees[1:] / max(degrees, 1e-9)))
        worst = int(np.argmin(merit))
        if not merit[worst] < 1.0:
            return found
        mass = np.bincount(label, area, R.shape[1])
        sides = [int(found.tree.order[worst]), int(found.tree.order[found.tree.parents[worst]])]
        gone = min(sides, key=lambda p: (mass[p], p))
        label = handed_over(V, x, label, gone, R, t, start, ring)
        kept = np.arange(R.shape[1]) != gone
        label = label - (label > gone)
        R, t, residual = (np.ascontiguousarray(a[:, kept]) for a in (R, t, residual))
        trust = None if trust is None else trust[:, kept]


def turning_range(turns: Floats) -> float:
    """The third largest, for two frames that may err, angle in degrees between any two of the rotations (frame, 3, 3)."""
    every = turns[:: max(1, len(turns) // POSES)].reshape(-1, 9)
    cosine = (every @ every.T - 1.0) / 2.0
    rank = min(3, len(every))
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    third = np.sort(angle, axis=1)[:, -rank]
    return float(np.degrees(np.sort(third)[-rank]))


def mean_rotation(turns: Floats) -> Floats:
    """(3, 3) the rotation nearest to the mean of those given (frame, 3, 3)."""
    U, _, Vt = np.linalg.svd(turns.mean(axis=0))
    U[:, 2] *= np.sign(np.linalg.det(U @ Vt))
    return U @ Vt


def _swing(V: Floats, area: Floats, inside: npt.NDArray[np.bool_], centre: Floats, turns: Floats, above: bool) -> float:
    """Root mean square way, over frames and a part's surface, of turning about the joint against the mean pose, mesh unit."""
    mean = mean_rotation(turns)
    arm = V[inside] - centre if above else (V[inside] - centre) @ mean.T
    spread = (area[inside, None] * arm).T @ arm / max(float(area[inside].sum()), np.finfo(float).tiny)
    away = turns @ mean.T - np.eye(3)
    return float(np.sqrt(np.einsum("txy,yz,txz->t", away, spread, away).mean()))


def _joined(V: Floats, met: Borders, label: Ints, count: int, size: float) -> Borders:
    """The borders, and one more between the nearest vertices wherever parts would hang on nothing."""
    of = np.arange(count)
    for a, b in met.pair:
        of[of == max(of[a], of[b])] = min(of[a], of[b])
    while (of != of[0]).any():
        near, far = np.flatnonzero(of[label] == of[0]), np.flatnonzero(of[label] != of[0])
        apart, row = KDTree(V[near]).query(V[far])
        k = int(np.argmin(apart))
        u, v = near[row[k]], far[k]
        pair = np.sort(label[[u, v]])
        met = Borders(
            np.concatenate([met.pair, pair[None]]),
            np.concatenate([met.centre, (V[u] + V[v])[None] / 2]),
            np.append(met.radius, 0.02 * size),
            np.append(met.length, 0.1 * size),
        )
        of[of == of[label[v]]] = of[0]
    return met
