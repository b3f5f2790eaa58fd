"""Joints of several parts on one part that are one joint with several bones (ours).

Bones that leave a joint in a bundle, such as the links from the pelvis to both hips, lie under skin that follows none of them
alone. Each one's rotation centre is then drawn along its bone, away from the joint that all share.
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_consensus import JointMotion


class SharedJointsSettings(NamedTuple):
    """When joints are one. Chosen on dance, forks 0 to 5, people and generated bodies; see RESULTS."""

    near: float = 1.0
    """Distance between two joints on the same part, in radii of the smaller border, below which they may be one. True ones lie
    at 0.29 to 0.94; others that would drift no more than `rise` at 1.08 and more."""
    rise: float = 1.5
    """Drift of each joint at the common place, at most, in its drift where it is. Others that are near: mostly 2.1 and more."""
    spread: float = 0.35
    """Standard deviation of the common place about each joint, in radii of its border, as in `KinematicTreeSettings`: decides
    where motion leaves it open. Errors of forks are 1.07 % at 0.35 to 0.7 and 1.02 at 1, those of dance 1.04 and 1.22."""
    noise: float = 0.001
    """Drift that is none, root of the area."""


class _Joint(NamedTuple):
    """What the frames say of one joint: M c = d with weights that sum to 1; its place, radius of its border and drift there."""

    M: Floats
    d: Floats
    weight: Floats
    place: Floats
    radius: float
    drift: float

    def drift_at(self, c: Floats) -> float:
        """Root mean square distance between a point as both parts carry it."""
        return float(np.sqrt(self.weight @ ((self.M @ c - self.d) ** 2).sum(axis=1)))


_Groups = list[tuple[tuple[int, ...], Floats]]
"""Parts whose joints are one, and where it is."""


def shared_joints(tree: FirstTree, rest: Floats, size: float, settings: SharedJointsSettings | None = None) -> Floats:
    """The joints in the reference, those that are one at one place.

    Of a part's joints with the parts below it, the nearest two become one while a common place explains both motions.

    rest    : (part, xyz) mesh unit
    size    : root of the area, mesh unit
    returns : (part, xyz) mesh unit; `rest` itself where none are one
    """
    chosen, moved = settings or SharedJointsSettings(), rest
    joints = [None, *_joints(tree.motion, rest[1:], tree.radius[1:], chosen.noise * size)]
    for above in np.unique(tree.parents[1:]).tolist():
        groups: _Groups = [((k,), rest[k]) for k in np.flatnonzero(tree.parents == above).tolist()]
        while (merged := _nearest_merged(groups, joints, chosen)) is not None:
            groups = merged
        for members, place in groups:
            if len(members) > 1:
                moved = np.where(np.isin(np.arange(len(rest)), members)[:, None], place, moved)
    return moved


def _joints(motion: JointMotion, rest: Floats, radius: Floats, noise: float) -> list[_Joint]:
    """Those of all parts but the root."""
    (own, above), (t_own, t_above) = motion.R, motion.t
    share = motion.weight / motion.weight.sum(axis=0)
    joints = []
    for k, (place, r) in enumerate(zip(rest, radius.tolist(), strict=True)):
        joint = _Joint(own[:, k] - above[:, k], t_above[:, k] - t_own[:, k], share[:, k], place, r, 0.0)
        joints.append(joint._replace(drift=max(joint.drift_at(place), noise)))
    return joints


def _nearest_merged(groups: _Groups, joints: list[_Joint | None], chosen: SharedJointsSettings) -> _Groups | None:
    """The groups with the two nearest that may be one made one; None where no two may."""
    apart = {(a, b): float(np.linalg.norm(groups[a][1] - groups[b][1])) for a, b in combinations(range(len(groups)), 2)}
    for (a, b), distance in sorted(apart.items(), key=lambda entry: entry[1]):
        members = groups[a][0] + groups[b][0]
        of = [joint for k in members if (joint := joints[k]) is not None]
        if distance >= chosen.near * min(joint.radius for joint in of):
            continue
        place = _common_place(of, chosen)
        if all(joint.drift_at(place) <= chosen.rise * joint.drift for joint in of):
            return [g for k, g in enumerate(groups) if k not in (a, b)] + [(members, place)]
    return None


def _common_place(joints: list[_Joint], chosen: SharedJointsSettings) -> Floats:
    """(xyz,) argmin_c Σ_j (Σ_t w |M c − d|² / drift² + |c − c_j|² / (ρ r)²), mesh unit."""
    A, g = np.zeros((3, 3)), np.zeros(3)
    for joint in joints:
        w, hold = joint.weight / joint.drift**2, 1.0 / max(chosen.spread * joint.radius, np.finfo(float).tiny) ** 2
        A += np.einsum("t,tyx,tyz->xz", w, joint.M, joint.M) + hold * np.eye(3)
        g += np.einsum("t,tyx,ty->x", w, joint.M, joint.d) + hold * joint.place
    return np.asarray(np.linalg.solve(A, g))
