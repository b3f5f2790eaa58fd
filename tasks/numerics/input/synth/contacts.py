"""Contacts: bending a limb by inverse kinematics until its end really touches another part of the body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.errors import FigureError
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.input.synth.descriptions import suggestion, triple
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.implicit import Cones, values
from kinetree.tasks.numerics.input.synth.motion import forward_kinematics

_KEYS = ("limb", "target", "begin", "end", "ramp", "direction")


class ContactSettings(NamedTuple):
    """How deep and how steeply a limb's end touches, and how inverse kinematics gets it there."""

    sink: float = 0.6
    """Depth of the limb's end in the target, share of its radius: enough for any sensible voxel to merge them."""
    steepness: float = 0.6
    """Sine of the angle at which the last bone stands off the skin."""
    iterations: int = 120
    """Most steps of inverse kinematics; it ends after half of them once the goal is reached."""
    damping: float = 1e-3
    """Damping of the least squares, share of the trace of J Jᵀ."""
    largest_step: float = 0.2
    """Most that a joint turns in one step, radian."""
    lift: float = 0.2
    """Share of the way to `steepness` that one step goes."""
    reached: float = 1e-4
    """Distance from the goal at which a step is the last, share of the height."""
    tolerance: float = 0.002
    """Distance from the goal from which the limb counts as too short, share of the height."""


_SETTINGS = ContactSettings()


@dataclass(frozen=True)
class Contact:
    """The end of `limb` touches the body at `target` in frames begin to end, both included.

    limb, target : joint indices
    ramp         : frames in which the limb comes before, and leaves after
    direction    : from the target's joint to the place that is touched, rest coordinates; None: where the limb is
    """

    limb: int
    target: int
    begin: int
    end: int
    ramp: int
    direction: tuple[float, float, float] | None

    @classmethod
    def of(cls, figure: Figure, row: Mapping[str, Any], frames: int) -> Contact:
        """Check a contact written as data: {limb, target, begin, end} and optionally ramp and direction.

        raises : FigureError at unknown keys or joints, at frames outside the clip, at a limb that cannot bend
        """
        where = f"contact {dict(row)}"
        for key in row:
            if key not in _KEYS:
                raise FigureError(f"{where}: unknown key {key!r}{suggestion(key, _KEYS)}")
        for key in _KEYS[:4]:
            if key not in row:
                raise FigureError(f"{where}: {key} is missing; a contact needs limb, target, begin and end")
        limb, target = (figure.index(str(row[key]), where) for key in ("limb", "target"))
        begin, end, ramp = (row.get(key, 5) for key in ("begin", "end", "ramp"))
        if not all(isinstance(n, int) and not isinstance(n, bool) for n in (begin, end, ramp)):
            raise FigureError(f"{where}: begin, end and ramp must be whole numbers of frames")
        if not 0 <= begin <= end < frames or ramp < 0:
            raise FigureError(f"{where}: expected 0 ≤ begin ≤ end < {frames} (the clip's frames) and ramp ≥ 0")
        chain = bending_chain(figure, limb)
        if not chain:
            raise FigureError(f"{where}: {row['limb']!r} has no joint to bend before the trunk; name the limb's end")
        if target in figure.below(chain[-1]) - {chain[-1]}:
            raise FigureError(f"{where}: {row['target']!r} is part of the limb that shall touch it")
        direction = row.get("direction")
        if direction is not None:
            direction = triple(where, "direction", direction)
            if not any(direction):
                raise FigureError(f"{where}: direction is {direction!r}, expected three numbers, not all zero")
        return cls(limb, target, begin, end, ramp, direction)

    def weights(self, frames: int) -> Floats:
        """(frame,) share of the contact's pose: 1 in the contact, falling steeply beside it so that the limb is free."""
        t = np.arange(frames)
        away = np.maximum(np.maximum(self.begin - t, t - self.end), 0)
        return np.asarray(np.clip(1.0 - away / (self.ramp + 1.0), 0.0, 1.0) ** 2, dtype=np.float64)


def bending_chain(figure: Figure, limb: int) -> list[int]:
    """Joints that a limb can bend, from its end to the trunk: ancestors with at most one child that has children."""
    parents = figure.parents
    inner = {int(p) for p in parents if p >= 0}
    branches = [sum(1 for c in inner if parents[c] == j) for j in range(len(parents))]
    chain, j = [], int(parents[limb])
    while j > 0 and branches[j] <= 1:
        chain.append(j)
        j = int(parents[j])
    return chain


def touching(figure: Figure, flesh: Flesh, contact: Contact, R: Floats, shift: Floats) -> Floats:
    """Joint rotations in which the limb's end touches its target, blended with the given ones beside the contact.

    R       : (frame, joint, 3, 3) rotations against the parent; shift : (frame, xyz) of the root
    returns : (frame, joint, 3, 3)
    raises  : FigureError if the limb is too short to reach
    """
    weight = contact.weights(len(R))
    busy = np.flatnonzero(weight > 0.0)
    chain = bending_chain(figure, contact.limb)
    goal, away = _goal(figure, flesh, contact, R, shift, chain)
    bent, miss = _reach(figure, contact.limb, chain, goal[busy], away[busy], R[busy], shift[busy])
    in_contact = weight[busy] == 1.0
    if miss[in_contact].max() > _SETTINGS.tolerance * figure.height:
        names = ", ".join(figure.joints[j].name for j in chain)
        raise FigureError(
            f"contact of {figure.joints[contact.limb].name!r} with {figure.joints[contact.target].name!r}: turning "
            f"{names} leaves the limb {miss[in_contact].max():.3g} {figure.unit} short of it; choose a nearer target"
        )
    blended = R.copy()
    for j in chain:
        step = Rotation.from_matrix(np.swapaxes(R[busy, j], 1, 2) @ bent[:, j]).as_rotvec()
        blended[busy, j] = R[busy, j] @ Rotation.from_rotvec(weight[busy, None] * step).as_matrix()
    return blended


def merging(figure: Figure, flesh: Flesh, contact: Contact, cones: Cones) -> Cones:
    """The limbs in a frame of the contact: the one that touches now blends with all that it may touch.

    Soft skins close the wedge beside a contact; without that, a grid would see tunnels where the wedge is thinner
    than a voxel. The blend is twice as wide as the limb's end and closes gaps of up to half its width.
    """
    touching_limb = int(np.flatnonzero(flesh.child == contact.limb)[0])
    own = sorted(figure.below(bending_chain(figure, contact.limb)[-1]))
    others = np.flatnonzero(~np.isin(flesh.parent, own))
    pairs = np.stack([np.full_like(others, touching_limb), others], axis=1)
    return cones._replace(
        first=np.concatenate([cones.first, cones.first[-1] + 2 * np.arange(1, len(others) + 1)]),
        members=np.concatenate([cones.members, pairs.ravel()]),
        reach=np.concatenate([cones.reach, np.full(len(others), 2.0 * figure.joints[contact.limb].radii[-1])]),
    )


def _goal(figure: Figure, flesh: Flesh, contact: Contact, R: Floats, shift: Floats, chain: list[int]) -> tuple[Floats, Floats]:
    """(frame, xyz) place of the limb's end, just under the skin beside the target, and (frame, xyz) the way out of it."""
    X, G = forward_kinematics(figure.rest, figure.parents, R, shift)
    carrier = max(int(figure.parents[contact.target]), 0)
    middle = (contact.begin + contact.end) // 2
    if contact.direction is None:
        u = G[middle, carrier].T @ (X[middle, contact.limb] - X[middle, contact.target])
    else:
        u = np.array(contact.direction)
    u /= np.linalg.norm(u)
    limb_bones = np.isin(flesh.parent, sorted(figure.below(chain[-1])))
    cones = flesh.at(X[middle], G[middle], without=limb_bones)
    ray = np.linspace(0.0, figure.height, 2001)
    field, _ = values(cones, X[middle, contact.target] + ray[:, None] * (G[middle, carrier] @ u))
    skin = ray[np.flatnonzero(field < 0.0)[-1]] if (field < 0.0).any() else 0.0
    end = figure.joints[contact.limb]
    depth = skin + (1.0 - _SETTINGS.sink) * end.radii[-1] * end.flatten
    away = G[:, carrier] @ u
    return X[:, contact.target] + depth * away, away


def _reach(
    figure: Figure, limb: int, chain: list[int], goal: Floats, away: Floats, R: Floats, shift: Floats
) -> tuple[Floats, Floats]:
    """Damped least squares on the chain's rotations, all frames at once: (frame, joint, 3, 3), (frame,) distance left.

    What freedom the goal leaves, lifts the limb's last bone off the body, so that its end touches and not its side.

    goal, away : (frame, xyz) place of the limb's end, and unit normal of the skin there
    """
    R = R.copy()
    for step in range(_SETTINGS.iterations):
        X, G = forward_kinematics(figure.rest, figure.parents, R, shift)
        e = goal - X[:, limb]
        if step >= _SETTINGS.iterations // 2 and np.linalg.norm(e, axis=1).max() < _SETTINGS.reached * figure.height:
            break
        J, K = (_jacobian(X, chain, joint) for joint in (limb, chain[0]))
        pinned = np.linalg.inv(J @ _T(J) + _SETTINGS.damping * np.trace(J @ _T(J), axis1=1, axis2=2)[:, None, None] * np.eye(3))
        omega = _T(J) @ pinned @ e[:, :, None]
        lift = (
            _SETTINGS.lift
            * _T(K)
            @ _lift(X[:, limb], X[:, chain[0]], away)[:, :, None]
            / (np.sum(K**2, axis=(1, 2))[:, None, None])
        )
        omega += lift - _T(J) @ pinned @ J @ lift
        turns = omega.reshape(len(R), len(chain), 3)
        turns /= np.maximum(1.0, np.linalg.norm(turns, axis=2, keepdims=True) / _SETTINGS.largest_step)
        for c, j in enumerate(chain):
            P = G[:, figure.parents[j]]
            R[:, j] = _T(P) @ Rotation.from_rotvec(turns[:, c]).as_matrix() @ P @ R[:, j]
    X, _ = forward_kinematics(figure.rest, figure.parents, R, shift)
    return R, np.asarray(np.linalg.norm(goal - X[:, limb], axis=1), dtype=np.float64)


def _jacobian(X: Floats, chain: list[int], joint: int) -> Floats:
    """(frame, xyz, 3 chain) how a joint moves with the rotations of the chain: ω at joint j moves it by ω × (x − x_j)."""
    blocks = np.zeros((len(X), 3, len(chain), 3))
    for c, j in enumerate(chain):
        x, y, z = (X[:, joint] - X[:, j]).T
        blocks[:, 0, c, 1], blocks[:, 0, c, 2] = z, -y
        blocks[:, 1, c, 0], blocks[:, 1, c, 2] = -z, x
        blocks[:, 2, c, 0], blocks[:, 2, c, 1] = y, -x
    return blocks.reshape(len(X), 3, -1)


def _lift(end: Floats, knuckle: Floats, away: Floats) -> Floats:
    """(frame, xyz) how far the last bone's other joint must go to stand off the skin as settings say; zero where it does."""
    bone = knuckle - end
    length = np.linalg.norm(bone, axis=1, keepdims=True)
    rise = np.einsum("ti,ti->t", bone, away)[:, None] / length
    level = bone / length - rise * away
    level /= np.maximum(np.linalg.norm(level, axis=1, keepdims=True), 1e-12)
    wanted = length * (_SETTINGS.steepness * away + np.sqrt(1.0 - _SETTINGS.steepness**2) * level)
    return np.where(rise < _SETTINGS.steepness, wanted - bone, 0.0)


def _T(A: Floats) -> Floats:
    return np.swapaxes(A, 1, 2)
