"""An articulated body fitted to the surface of one frame, from a pose not too far (2014, Sec. 7.3; ours).

E = Σ across the surface, both ways (`surface_matches`) + α Σ weight |x_v − aligned_v|² + Σ_a hold_a |log(turn_a expected_aᵀ)|²,
by Gauss–Newton over the rotations of all parts and the root's shift, bones of fixed length, from wide to narrow. A part that
the frame does not show is held where it was expected; the more the frame shows of it, the less it is held.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_fit import rotations
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, SkinnedBody, add_equations, joints
from kinetree.tasks.numerics.structure.surface_matches import MatchEquations, Matches, equations, followed, searched

DAMPING = 1e-6
"""Added to the diagonal of the normal equations, share of its mean: keeps them solvable."""


class SurfaceFitSettings(NamedTuple):
    """How a body is fitted."""

    scales: tuple[float, ...] = (0.1, 0.06, 0.036, 0.022, 0.015, 0.012, 0.012, 0.012)
    """Distance at which a match counts a quarter, share of the root of the area, step by step. Not recorded."""
    search_every: int = 2
    """Steps after which matches are searched everywhere; between them they are followed. Not recorded; for time."""
    along: float = 0.05
    """Weight of a match's distance along the surface against that across it. Not recorded."""
    aligned: float = 0.5
    """α: weight of aligned vertices against the surface. Not recorded."""
    faint: float = 0.5
    """Confidence below which an aligned vertex has no weight. Not recorded."""
    hardly_seen: float = 0.3
    """Confidence of a part below which its aligned vertices weigh less. Not recorded."""
    hold: float = 0.002
    """Weight of the expected rotation against a part's surface, seen in full. Chosen with limbs off by 50°: held five times as
    firmly they did not come back."""
    hold_unseen: float = 0.02
    """Weight added where nothing of a part is seen. Not recorded."""
    longest_step: float = 0.5
    """Radians by which a part turns in one step, at most. Not recorded."""


def fitted_to_surface(
    body: SkinnedBody,
    start: FramePose,
    target: Target,
    aligned: Floats,
    weight: Floats,
    expected: Floats,
    settings: SurfaceFitSettings | None = None,
) -> FramePose:
    """The pose that covers the frame's surface best, from a pose not too far.

    aligned  : (vertex, xyz) where each vertex is aligned to, mesh unit
    weight   : (vertex,) of the aligned vertices
    expected : (part, 3, 3) rotations against the parents, the root's in space
    """
    chosen = settings or SurfaceFitSettings()
    pose, found = start, None
    for step, scale in enumerate(chosen.scales):
        search = found is None or step % chosen.search_every == 0
        found = searched(body, pose, target) if search or found is None else followed(body, pose, target, found)
        surface = equations(body, target, found, scale * body.size, chosen.along)
        pose = _stepped(body, pose, surface, _aligned_equations(body, found, aligned, weight, chosen), expected, chosen)
    return pose


def aligned_weight(body: SkinnedBody, confidence: Floats, sure: Floats, settings: SurfaceFitSettings | None = None) -> Floats:
    """Weight of the aligned vertices: none where confidence is faint, less on parts that are hardly seen.

    At the edge of a lost limb are vertices that the flesh around it has drawn to itself.

    confidence : (vertex,) 0 to 1
    sure       : (part,) confidence of the parts, 0 to 1
    returns    : (vertex,) 0 to 1
    """
    chosen = settings or SurfaceFitSettings()
    clear = np.clip((confidence - chosen.faint) / (1.0 - chosen.faint), 0.0, 1.0) ** 2
    weight: Floats = clear * np.minimum(sure / chosen.hardly_seen, 1.0)[body.label] ** 2
    return weight


def surface_support(body: SkinnedBody, surface: MatchEquations) -> Floats:
    """(part,) 0 to 1: share of each part's surface that the frame's matches weigh, in the direction that has more."""
    count, sampled = len(body.parents), len(body.sample)
    part = body.label[surface.vertex]
    ways = [np.bincount(part[way], surface.plane[way], count) for way in (slice(sampled), slice(sampled, None))]
    whole = np.maximum(np.bincount(body.label[body.sample], body.mass, count), 1e-300)
    return np.minimum(np.maximum(*ways) / whole, 1.0)


def _stepped(
    body: SkinnedBody,
    pose: FramePose,
    surface: MatchEquations,
    aligned: MatchEquations,
    expected: Floats,
    chosen: SurfaceFitSettings,
) -> FramePose:
    """One Gauss–Newton step."""
    count = len(body.parents)
    H, g = np.zeros((3 * count + 3, 3 * count + 3)), np.zeros(3 * count + 3)
    R, X = np.ascontiguousarray(pose.R), joints(body, pose)
    for rows in (surface, aligned):
        add_equations(H, g, *rows, body.V, body.bound, body.weight, body.rest, body.parents, R, X)
    unseen = (1.0 - surface_support(body, surface)) ** 2
    _hold(H, g, R, body.parents, expected, body.reach * (chosen.hold + chosen.hold_unseen * unseen))
    H[-3:, :-3] = H[:-3, -3:].T
    diagonal = np.arange(len(g))
    H[diagonal, diagonal] += DAMPING * np.trace(H) / len(g)
    move: Floats = np.linalg.solve(H, g).astype(np.float64)
    omega = move[:-3].reshape(count, 3)
    share = min(1.0, chosen.longest_step / max(float(np.linalg.norm(omega, axis=1).max()), 1e-12))
    return FramePose(rotations(share * omega) @ R, pose.x + share * move[-3:])


def _aligned_equations(
    body: SkinnedBody, found: Matches, aligned: Floats, weight: Floats, chosen: SurfaceFitSettings
) -> MatchEquations:
    """The aligned vertices, in all directions alike."""
    s = body.sample
    d = aligned[s] - found.x[s]
    return MatchEquations(s, d, np.zeros_like(d), np.zeros(len(s)), chosen.aligned * body.mass * weight[s])


def _hold(H: Floats, g: Floats, R: Floats, parents: Ints, expected: Floats, firm: Floats) -> None:
    """Adds firm |log(R_p expected R_aᵀ)|² for every part a."""
    above = R[np.maximum(parents, 0)]
    above[0] = np.eye(3)
    M = above @ expected @ R.transpose(0, 2, 1)
    away = np.stack([M[:, 2, 1] - M[:, 1, 2], M[:, 0, 2] - M[:, 2, 0], M[:, 1, 0] - M[:, 0, 1]], axis=1) / 2
    _add_holds(H, g, away, parents, firm)


@compiled
def _add_holds(H: Floats, g: Floats, away: Floats, parents: Ints, firm: Floats) -> None:
    """Adds firm |turn of a − turn of its parent − away|² to the normal equations."""
    for a in range(len(parents)):
        p = parents[a]
        for x in range(3):
            i, j = 3 * a + x, 3 * p + x
            H[i, i] += firm[a]
            g[i] += firm[a] * away[a, x]
            if p >= 0:
                H[j, j] += firm[a]
                H[i, j] -= firm[a]
                H[j, i] -= firm[a]
                g[j] -= firm[a] * away[a, x]
