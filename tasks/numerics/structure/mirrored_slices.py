"""Slices of flesh at the inner ends of both limbs of a pair, which their mirror images do not tell from bones (ours).

An arm that swings far pulls the flesh of chest and shoulder along: it turns by a share of what the arm turns by, on both sides
alike, and becomes a part of its own. Between two bones flesh is a mixture of both; a bone of its own is none.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_partners import Limb, RootedParts, mirrored_limbs
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface


class MirroredSlicesSettings(NamedTuple):
    """When the innermost parts of both limbs are slices.

    Chosen on people 0 to 19, 60 to 69 and 86 to 144, of whom five, all running, have slices beside both shoulders, and on the
    dance.
    """

    length: float = 2.2
    """Length of both, from joint to joint, in radii of their smaller border, at most. Slices beside shoulders have 1.1 to 2.1.
    """
    least_length: float = 1.2
    """The same of the longer one, at least: slices beside shoulders have 1.4 and more, true links from the pelvis to both hips
    of the dance 0.8 and 1.03, flesh above the hips of person 124 0.9."""
    alike: float = 1.5
    """Length of one in that of the other, at most. Those have 1.1 to 1.27; a pelvis that one limb hangs on and flesh above the
    other hip 2.4 and 2.5."""
    mixture: float = 3.6
    """How much more a mixture of the motions of both neighbours leaves of the part than one of its own with either, at most.
    Slices have 2.2 to 3.5."""
    outer: float = 0.5
    """Distance from its outer joint, in that from its inner joint, below which a vertex goes to the limb and not to the trunk.
    Shoulders err least so of 0, 0.3, 0.5 and 1; with all that moves like the arm two are lost."""


class Slice(NamedTuple):
    """A part that is a slice.

    part, above, below : its place in the tree, and those of its neighbours
    is_below           : (vertex,) which vertices go to the part below it rather than to that above
    """

    part: int
    above: int
    below: int
    is_below: Flags


def mirrored_slices(
    body: MovingSurface,
    tree: FirstTree,
    pairs: LimbPairs,
    confidence: Floats,
    paired: float,
    settings: MirroredSlicesSettings | None = None,
) -> list[Slice]:
    """The parts of the tree that are slices, each once.

    pairs      : limbs that are mirror images
    confidence : (frame, vertex) 0 to 1
    paired     : radii, see `joint_partners.PAIRED`
    """
    chosen, parts = settings or MirroredSlicesSettings(), RootedParts(tree.label, tree.parents, tree.radius)
    found = dict[int, Slice]()
    for one, other, _ in mirrored_limbs(body.F, parts, pairs, paired):
        lengths = [_length(tree, limb) for limb in (one, other)]
        if chosen.least_length <= max(lengths) <= min(chosen.length, chosen.alike * min(lengths)):
            both = [_slice(body, tree, limb, chosen) for limb in (one, other)]
            if all(_mixture(body, tree, each, confidence) <= chosen.mixture for each in both):
                found |= {each.part: each for each in both}
    return [found[part] for part in sorted(found)]


def _length(tree: FirstTree, limb: Limb) -> float:
    """Of a limb's innermost part, in radii; infinite where it is the last part too, or carries two parts."""
    if len(limb.part) < 2 or (tree.parents == limb.part[-1]).sum() != 1:
        return np.inf
    below, part = limb.part[-2:]
    radius = max(float(min(tree.radius[part], tree.radius[below])), float(np.finfo(float).tiny))
    return float(np.linalg.norm(tree.rest[part] - tree.rest[below]) / radius)


def _slice(body: MovingSurface, tree: FirstTree, limb: Limb, chosen: MirroredSlicesSettings) -> Slice:
    """A limb's innermost part."""
    below, part = limb.part[-2:].tolist()
    inner, outer = (np.linalg.norm(body.V - tree.rest[k], axis=1) for k in (part, below))
    return Slice(part, int(tree.parents[part]), below, outer < chosen.outer * inner)


def _mixture(body: MovingSurface, tree: FirstTree, one: Slice, confidence: Floats) -> float:
    """What mixtures of the motions above and below a part leave of it, in what mixtures of its own with either leave."""
    own, motions = tree.label == one.part, (one.above, one.part, one.below)
    above, part, below = (np.einsum("fxy,vy->fvx", tree.R[:, k], body.V[own]) + tree.t[:, None, k] for k in motions)
    between = _left(body.x[:, own], above, below, confidence[:, own])
    by_itself = np.minimum(*(_left(body.x[:, own], part, other, confidence[:, own]) for other in (above, below)))
    area, tiny = body.area[own], float(np.finfo(float).tiny)
    return float(np.sqrt(area @ between / max(float(area @ by_itself), tiny)))


def _left(x: Floats, one: Floats, other: Floats, confidence: Floats) -> Floats:
    """(vertex,) mean squared distance of vertices from the best mixture of two places; each (frame, vertex, xyz), mesh unit."""
    away, tiny = one - other, np.finfo(float).tiny
    along, square = ((x - other) * away).sum(axis=2), (away**2).sum(axis=2)
    share = (confidence * along).sum(axis=0) / np.maximum((confidence * square).sum(axis=0), tiny)
    off = x - other - np.clip(share, 0.0, 1.0)[None, :, None] * away
    return np.asarray((confidence * (off**2).sum(axis=2)).sum(axis=0) / np.maximum(confidence.sum(axis=0), tiny))
