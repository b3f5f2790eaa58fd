"""Two limbs that are one part, cut apart by their shape: limbs that move alike are one rigid body, and yet two bones (ours).

In a bow both thighs turn against the trunk as one, about one line through both hips, and the skin between them goes along, so
that no motion tells them apart. The shape does: the shortest path over the surface between the ends of two legs passes the
crotch half-way, and what lies nearer to an end than that is of a leg alone. The part is cut where both ends are equally far.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Ints
from kinetree.tasks.numerics.structure.joint_rotations import principal_axis
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree, relative_rotation


class AlikeLimbsSettings(NamedTuple):
    """When a part is two limbs.

    Of 73 bodies (wave, dance, ballet, wolf, people 0 to 19, 60 to 69 and 86 to 99, humans, four-legged and random trees) three
    have such a part, and no other part between two mirrored limbs has a quarter of its surface on each and one other neighbour.
    """

    limb: float = 0.33
    """Share of the part's surface that lies on each limb, at least. Those three have 0.37 to 0.43, the next one 0.23."""
    along: float = 0.8
    """Cosine of the angle between the line about which the part turns and that from one limb to the other, at least. Those have
    0.90 to 1.00; where a trunk twists or bends aside it is none."""
    near: float = 1.75
    """Distance of the joint from that line, in radii of the limbs, at most. Those have 0.8 to 1.1, both thighs of a body with
    slim legs, which is not among them, 1.6; the joint of a spine that bends above a pelvis at rest lies two radii higher."""
    band: float = 0.06
    """Length of the limbs below the crotch whose radius counts, share of the root of the area. Not varied."""


def alike_limbs(
    body: MovingSurface,
    parts: MovingParts,
    found: PartTree,
    leaves: Ints,
    pairs: LimbPairs,
    settings: AlikeLimbsSettings | None = None,
) -> Iterator[tuple[int, Ints]]:
    """The parts that are two limbs of a pair and have no third end, each with its vertices that are of the second one.

    found  : the tree of the parts
    leaves : (leaf,) vertices at the ends of limbs
    pairs  : those that are mirror images
    """
    chosen = settings or AlikeLimbsSettings()
    for tips, away in zip(*pairs, strict=True):
        half = float(away[0][tips[1]] + away[1][tips[0]]) / 4.0
        if np.isfinite(half) and half > 0.0:
            for part, beside in _between(parts, found, tips):
                own = parts.label == part
                is_third = own[np.setdiff1d(leaves, tips)].any()
                is_high = away > half - chosen.band * body.size
                if not is_third and _are_limbs(body, parts, found, (part, beside), own & (away < half), is_high, chosen):
                    yield part, np.flatnonzero(own & (away[1] < away[0]))


def _between(parts: MovingParts, found: PartTree, tips: Ints) -> list[tuple[int, int]]:
    """The parts on the way from one end to the other with one neighbour that is not on it, and that neighbour."""
    tree = found.tree
    place = np.argsort(tree.order)[parts.label[tips]].tolist()
    ways = [_upwards(tree.parents, k) for k in place]
    way = {*ways[0]} ^ {*ways[1]} | {next(k for k in ways[0] if k in ways[1])}
    out = []
    for k in sorted(way):
        beside = {*np.flatnonzero(tree.parents == k).tolist(), *([int(tree.parents[k])] if k else [])} - way
        if len(beside) == 1:
            out.append((int(tree.order[k]), int(tree.order[beside.pop()])))
    return out


def _upwards(parents: Ints, place: int) -> list[int]:
    """A place in the tree and all above it, up to the root."""
    way = [place]
    while parents[way[-1]] >= 0:
        way.append(int(parents[way[-1]]))
    return way


def _are_limbs(
    body: MovingSurface, parts: MovingParts, found: PartTree, pair: tuple[int, int], on_limb: Flags, is_high: Flags,
    chosen: AlikeLimbsSettings,
) -> bool:  # fmt: skip
    """Whether a part is two limbs that turn alike against its neighbour, about a line through both.

    pair             : the part and its neighbour
    on_limb, is_high : (2, vertex) which of the part's vertices are of each limb · which lie near the crotch or beyond
    """
    part, beside = pair
    share = on_limb @ body.area / max(float(body.area[parts.label == part].sum()), np.finfo(float).tiny)
    tops = on_limb & is_high
    if share.min() < chosen.limb or not (tops @ body.area > 0.0).all():
        return False
    middle = np.array([np.average(body.V[top], axis=0, weights=body.area[top]) for top in tops])
    radius = np.mean([np.median(np.linalg.norm(body.V[top] - c, axis=1)) for top, c in zip(tops, middle, strict=True)])
    line = (middle[1] - middle[0]) / max(float(np.linalg.norm(middle[1] - middle[0])), np.finfo(float).tiny)
    row = int(np.flatnonzero((found.borders.pair == sorted(pair)).all(axis=1))[0])
    away = found.joints.rest[row] - middle.mean(axis=0)
    axis = principal_axis(relative_rotation(parts.R, beside, part))
    is_near = np.linalg.norm(away - (away @ line) * line) <= chosen.near * radius
    return bool(is_near and abs(axis @ line) >= chosen.along)
