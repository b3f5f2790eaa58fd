"""Joints of several parts on one part that are one joint with several bones (ours).

Bones that leave a joint in a bundle, such as the links from the pelvis to both hips, lie under skin that follows none of them
alone. Each one's rotation centre is then drawn along its bone, away from the joint that all share. Joints that the frames'
surfaces show were told apart there: a chest and a pelvis that twist on either side of the root have any place on one line.
"""

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_rotations import widest_turning_range
from kinetree.tasks.numerics.structure.part_tree import PartTreeSettings, relative_rotation
from kinetree.tasks.numerics.structure.score_spans import score_spans


class SharedJointsSettings(NamedTuple):
    """When joints are one. Chosen on dance, six forks, people and generated bodies, where true and false ones overlap; see
    RESULTS.
    """

    near: float = 1.1
    """Distance between two joints on the same part, in radii of the smaller border, below which they may be one. True ones lie
    at 0.3 to 0.99, two false ones that `rise` lets pass at 0.85 and 0.96. From 1 to 1.25 the same joints are one."""
    rise: float = 1.5
    """Drift of each joint at the common place, at most, in its drift where it is. At 1.75 one body loses a joint."""
    lean: float = 1.2
    """The same, at most, in its drift as far on the other side of where it is: where motion would rather have two joints
    farther apart they are two. In all frames true ones have 1.03 at most, hips of persons 12 and 69 1.4 and 1.7; at a quarter
    of the frames two of eleven true pairs have 1.4 and 1.7 as well and stay apart."""
    spread: float = 0.35
    """Standard deviation of the common place about each joint, in radii of its border: decides where motion leaves it open.
    Errors of forks are 1.07 % at 0.35 to 0.7 and 1.02 at 1, those of dance 1.04 and 1.22."""
    noise: float = 0.001
    """Drift that is none, root of the area."""


class SharedJoints(NamedTuple):
    """The joints in the reference, those that are one at one place.

    rest      : (part, xyz) mesh unit; the array that was given where none are one
    is_shared : (part,) whether the joint is one with another
    """

    rest: Floats
    is_shared: Flags


class _Joint(NamedTuple):
    """What the frames say of one joint: M c = d, by weight; its place, and the radius of its border."""

    M: Floats
    d: Floats
    weight: Floats
    place: Floats
    radius: float

    def drift_at(self, c: Floats, spans: Ints, noise: float) -> Floats:
        """(span,) root mean square distance between a point as both parts carry it, at least the noise."""
        square = self.weight * ((self.M @ c - self.d) ** 2).sum(axis=1)
        mean = [square[begin:end].sum() / self.weight[begin:end].sum() for begin, end in spans]
        return np.maximum(np.sqrt(mean), noise)


_Groups = list[tuple[tuple[int, ...], Floats]]
"""Parts whose joints are one, and where it is."""


class _Judge(NamedTuple):
    """What says whether joints are one: (frame, part, 3, 3) motions, the joints of all parts but the root, frames, limits.

    shown : joints that the frames' surfaces alone show
    """

    R: Floats
    joints: list[_Joint]
    shown: frozenset[int]
    spans: Ints
    noise: float
    chosen: SharedJointsSettings

    def drifts(self, joints: Sequence[_Joint], places: Sequence[Floats]) -> Floats:
        """(joint, span) drift of each joint at a place (xyz,) of its own, mesh unit."""
        return np.array([joint.drift_at(c, self.spans, self.noise) for joint, c in zip(joints, places, strict=True)])

    def are_told_apart(self, some: Sequence[int], others: Sequence[int]) -> bool:
        """Whether the frames' surfaces show a joint of both."""
        return not (self.shown.isdisjoint(some) or self.shown.isdisjoint(others))

    def move_alike(self, some: Sequence[int], others: Sequence[int]) -> bool:
        """Whether some part hardly turns against one of the others, so that any place on one line explains both."""
        still = PartTreeSettings().still
        return any(widest_turning_range(relative_rotation(self.R, a, b), self.spans) < still for a in some for b in others)


def shared_joints(
    tree: FirstTree,
    rest: Floats,
    size: float,
    takes: Sequence[slice] | None = None,
    settings: SharedJointsSettings | None = None,
) -> SharedJoints:
    """Puts joints that are one at one place.

    Of a part's joints with the parts below it, the nearest two become one while a common place explains both motions.

    rest  : (part, xyz) in the reference, mesh unit
    size  : root of the area, mesh unit
    takes : positions of the frames of each take, each of which may show that joints are two; None takes all as one
    """
    chosen, moved, is_shared = settings or SharedJointsSettings(), rest, np.zeros(len(rest), np.bool_)
    judge = _Judge(
        tree.R, _joints(tree, rest), frozenset(tree.shown), score_spans(len(tree.R), takes), chosen.noise * size, chosen
    )
    for above in np.unique(tree.parents[1:]).tolist():
        groups: _Groups = [((k,), rest[k]) for k in np.flatnonzero(tree.parents == above).tolist()]
        while (merged := _nearest_merged(groups, judge)) is not None:
            groups = merged
        for members, place in groups:
            if len(members) > 1:
                of_one = np.isin(np.arange(len(rest)), members)
                moved, is_shared = np.where(of_one[:, None], place, moved), is_shared | of_one
    return SharedJoints(moved, is_shared)


def _joints(tree: FirstTree, rest: Floats) -> list[_Joint]:
    """Those of all parts but the root."""
    (own, above), (t_own, t_above), weight = tree.motion
    return [
        _Joint(own[:, k] - above[:, k], t_above[:, k] - t_own[:, k], weight[:, k], place, float(radius))
        for k, (place, radius) in enumerate(zip(rest[1:], tree.radius[1:], strict=True))
    ]


def _nearest_merged(groups: _Groups, judge: _Judge) -> _Groups | None:
    """The groups with the two nearest that may be one made one; None where no two may."""
    chosen = judge.chosen
    apart = {(a, b): float(np.linalg.norm(groups[a][1] - groups[b][1])) for a, b in combinations(range(len(groups)), 2)}
    for (a, b), distance in sorted(apart.items(), key=lambda entry: entry[1]):
        some, others = groups[a][0], groups[b][0]
        members = some + others
        of = [judge.joints[k - 1] for k in members]
        is_near = distance < chosen.near * min(joint.radius for joint in of)
        if not is_near or judge.are_told_apart(some, others) or judge.move_alike(some, others):
            continue
        here = judge.drifts(of, [joint.place for joint in of])
        place = _common_place(of, here[:, 0].tolist(), chosen.spread)
        common = judge.drifts(of, [place] * len(of))
        opposite = judge.drifts(of, [2.0 * joint.place - place for joint in of])
        if ((common <= chosen.rise * here) & (common <= chosen.lean * opposite)).all():
            return [g for k, g in enumerate(groups) if k not in (a, b)] + [(members, place)]
    return None


def _common_place(joints: Sequence[_Joint], drifts: Sequence[float], spread: float) -> Floats:
    """(xyz,) argmin_c Σ_j (Σ_t w |M c − d|² / Σ_t w / drift² + |c − c_j|² / (ρ r)²), mesh unit.

    drifts : of every joint where it is, over all frames, mesh unit
    spread : ρ
    """
    A, g = np.zeros((3, 3)), np.zeros(3)
    for joint, drift in zip(joints, drifts, strict=True):
        w, hold = joint.weight / joint.weight.sum() / drift**2, 1.0 / (spread * joint.radius) ** 2
        A += np.einsum("t,tyx,tyz->xz", w, joint.M, joint.M) + hold * np.eye(3)
        g += np.einsum("t,tyx,ty->x", w, joint.M, joint.d) + hold * joint.place
    return np.asarray(np.linalg.solve(A, g))
