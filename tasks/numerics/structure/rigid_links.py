"""Bones that no skin shows: both ends stay equally far from each other, however the parts beside them move (ours).

A bone that joins two parts by a ball joint at either end holds a point of one part at a constant distance from a point of the
other. These two points follow from the motions of the parts alone, without any vertex that follows the bone (McCarthy 2000,
Geometric Design of Linkages, the spatial SS dyad). No single point serves such parts as their joint, so that a joint fitted to
them drifts.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats

STEPS = 40
"""Steps of Levenberg and Marquardt, at most; fits take 5 to 20."""
CONVERGED = 1e-6
"""Step, in radii of the border, below which the ends stay. Not varied."""


class RigidLinksSettings(NamedTuple):
    """How firmly the ends are held where they are expected; lengths are in radii of the border.

    Chosen on a dance, which alone has such bones; on eleven other bodies none is found (RESULTS).
    """

    spread: float = 1.0
    """Standard deviation of an end about where it is expected. With 0.5 the dance has none of its two links, with 0.7 one; with
    2 a false one is found in an arm."""
    frames_alike: float = 36.0
    """Frames that err alike, so that more frames say no more. With 5 the dance has none of its two links, with 12 one; with 72
    and 300 both."""
    starts: float = 1.5
    """Distance of the upper end from the joint at which fits begin. With 0.7 to 3 the links are the same."""


class Between(NamedTuple):
    """How the part below moves against the part above: a point h of it lies at Q h + q in the reference of the part above.

    Q, q   : (frame, 3, 3) · (frame, xyz) mesh unit
    radius : of their border, mesh unit
    noise  : root mean square of what these motions leave unexplained, mesh unit; at least 0.0001 radii count

    The radius is not 0.
    """

    Q: Floats
    q: Floats
    radius: float
    noise: float

    @classmethod
    def of(cls, above: tuple[Floats, Floats], below: tuple[Floats, Floats], radius: float, noise: float) -> "Between":
        """Of the motions (frame, 3, 3) · (frame, xyz) of both parts from the reference."""
        turned = above[0].transpose(0, 2, 1)
        least = max(noise, 1e-4 * radius)
        return cls(turned @ below[0], (turned @ (below[1] - above[1])[..., None])[..., 0], radius, least)

    def apart(self, ends: Floats) -> Floats:
        """(frame, xyz) from the upper to the lower of two ends (side, xyz), in the reference of the part above, mesh unit."""
        return np.asarray(self.Q @ ends[1] + self.q - ends[0])


class RigidLink(NamedTuple):
    """A bone of constant length.

    ends      : (side, xyz) in the part above and in the part below, in the reference, mesh unit
    length    : mean distance of the ends, mesh unit
    deviation : standard deviation of it over the frames, mesh unit
    cost      : what `rigid_link` makes least
    """

    ends: Floats
    length: float
    deviation: float
    cost: float


def rigid_link(between: Between, expected: Floats, spread: float, alike: float, begin: Floats | None = None) -> RigidLink:
    """The ends c, h = argmin Σ_t (|y_t| − l)² / σ² + max(T / alike, 1) |(c, h) − expected|² / (spread r)².

    y_t = Q_t h + q_t − c, l the mean of |y_t|.

    expected : (side, xyz) in the reference, mesh unit
    spread   : in radii of the border
    alike    : frames that err alike
    begin    : (side, xyz) where the search begins; None begins where the ends are expected
    """
    firm = np.sqrt(max(len(between.q) / alike, 1.0)) / (spread * between.radius)
    ends, damping = np.array(expected if begin is None else begin, dtype=np.float64), 1e-3
    left, J = _left(between, ends, expected, firm)
    for _ in range(STEPS):
        A, g = J.T @ J, J.T @ left
        step = -np.linalg.solve(A + damping * np.diag(np.diag(A)), g).reshape(2, 3)
        tried, J_there = _left(between, ends + step, expected, firm)
        if tried @ tried < left @ left:
            ends, left, J, damping = ends + step, tried, J_there, max(damping / 5.0, 1e-9)
            if np.abs(step).max() < CONVERGED * between.radius:
                break
        elif (damping := damping * 5.0) > 1e6:
            break
    distance = np.linalg.norm(between.apart(ends), axis=1)
    return RigidLink(ends, float(distance.mean()), float(distance.std()), float(left @ left))


def likeliest_link(between: Between, joint: Floats, chosen: RigidLinksSettings) -> RigidLink:
    """The link of least cost of those found from six places of its upper end around the joint (xyz,) of both parts."""
    expected, away = np.stack([joint, joint]), chosen.starts * between.radius
    begins = [np.stack([joint + sign * away * axis, joint]) for axis in np.eye(3) for sign in (1.0, -1.0)]
    links = [rigid_link(between, expected, chosen.spread, chosen.frames_alike, begin) for begin in begins]
    return min(links, key=lambda link: link.cost)


def link_motion(above: tuple[Floats, Floats], below: tuple[Floats, Floats], ends: Floats, R: Floats) -> tuple[Floats, Floats]:
    """(frame, 3, 3) · (frame, xyz) a bone that lies between both ends as the parts carry them, turned about itself as R is.

    above, below : (frame, 3, 3) · (frame, xyz) motions of both parts
    ends         : (side, xyz) in the reference, mesh unit
    R            : (frame, 3, 3) a turn of the bone that is about right
    """
    upper, lower = (R_k @ end + t_k for (R_k, t_k), end in zip((above, below), ends, strict=True))
    turned = _least_turns(R @ (ends[1] - ends[0]), lower - upper) @ R
    return turned, (upper + lower) / 2.0 - turned @ ends.mean(axis=0)


def _left(between: Between, ends: Floats, expected: Floats, firm: float) -> tuple[Floats, Floats]:
    """(residual,) what is made small, and its derivatives (residual, 6) by both ends."""
    y = between.apart(ends)
    distance = np.linalg.norm(y, axis=1)
    along = y / np.maximum(distance, np.finfo(float).tiny)[:, None]
    J = np.concatenate([-along, (along[:, None] @ between.Q)[:, 0]], axis=1)
    length = (distance - distance.mean()) / between.noise
    stays = firm * (ends - expected).ravel()
    return np.concatenate([length, stays]), np.concatenate([(J - J.mean(axis=0)) / between.noise, firm * np.eye(6)])


def _least_turns(a: Floats, b: Floats) -> Floats:
    """(frame, 3, 3) the least turns that take directions a (frame, xyz) to b; a and b are not opposite."""
    a, b = (v / np.maximum(np.linalg.norm(v, axis=1, keepdims=True), np.finfo(float).tiny) for v in (a, b))
    half = a + b
    half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), np.finfo(float).tiny)
    flip_a, flip_half = (2.0 * v[:, :, None] * v[:, None] - np.eye(3) for v in (a, half))
    return np.asarray(flip_half @ flip_a)
