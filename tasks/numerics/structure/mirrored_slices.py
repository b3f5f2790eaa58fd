"""Slices of flesh in limbs of a pair, which their mirror images do not tell from bones (ours).

An arm that swings far pulls the flesh of chest and shoulder along: it turns by a share of what the arm turns by, on both sides
alike, and becomes a part of its own. The arm's joint is then two, one on either side of the true one. Between two bones flesh
is a mixture of both; a bone of its own is none. Farther out a slice is clearer: no pelvis and no shoulder blade moves there.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_partners import Limb, MirroredLimbs, RootedParts, mirrored_limbs, parts_touch
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.limbs_apart import FIT_FLOOR
from kinetree.tasks.numerics.structure.part_motion import fit, residuals
from kinetree.tasks.numerics.structure.part_tree import MovingSurface


class SliceLimits(NamedTuple):
    """What slices are at most.

    least   : length of the longer one, from joint to joint, in radii of their smaller border, at least
    length  : the same, at most
    alike   : length of one in that of the other
    mixture : how much more a mixture of the motions of both neighbours leaves of the part than one of its own with either
    """

    least: float
    length: float
    alike: float
    mixture: float


class MirroredSlicesSettings(NamedTuple):
    """When parts of limbs are slices.

    Chosen on people 0 to 19, 60 to 69 and 86 to 144, of whom five, all running, have slices beside both shoulders, on the
    dance, and on a person's body with collar bones in sixteen generated motions, of which seven show slices beside shoulders.
    """

    touching: SliceLimits = SliceLimits(1.2, 2.2, 1.5, 3.6)
    """Of parts that touch each other, as those about a pelvis do: the two halves of a wolf's have lengths of 2.5 and 2.9, and
    mixtures of 2.8 and 3.9; a pelvis that one limb hangs on is 2.4 times as long as flesh above the other hip. True links from
    the pelvis to both hips of the dance are 0.8, 1.03 and 1.13 long, flesh above the hips of person 124 0.9."""
    apart: SliceLimits = SliceLimits(0.5, 3.9, 2.5, 5.2)
    """Of parts that do not. Slices beside shoulders have lengths of 1.0 to 3.8, the longer one of 1.17 and more, at most 2.4
    times the other's, and mixtures of 1.3 to 5.1; flesh above the hips of persons 740 and 892, who run, 0.62 to 0.77, and 1.7
    to 3.0. Upper arms and thighs of people have lengths of 4.8 and more, of four-legged bodies 3.6 and more (`most_drift`)."""
    opposed: SliceLimits = SliceLimits(0.0, 2.2, 2.0, 5.2)
    """Of parts that touch each other and move as two, as flesh of two thighs does and links from a pelvis to both hips do not;
    they may be as short as can be. People 556 and 604, who run, and 628 and 704 have such parts, with lengths of 0.5 to 1.4 and
    mixtures of 1.7 to 4.5."""
    unequal: SliceLimits = SliceLimits(0.0, 1.5, np.inf, 3.6)
    """Of parts that touch each other, do not move as two, and are not as long as each other, as bones of both limbs are. People
    684, 692 and 708, who run, and human 14 have such flesh about a pelvis, with lengths of 0.3 to 1.26 and mixtures of 1.2 to
    3.3; one side of people 4 and 88 is the pelvis itself, with lengths of 1.9 and 2.1."""
    longer_of_unequal: float = 1.4
    """Length of one in that of the other from which on they are not as long as each other. Such flesh has 1.6 to 2.9, links
    from the pelvis to both hips of the dance 1.2."""
    as_two: float = 2.1
    """What one motion leaves of both parts, in what a motion of its own leaves of each, above which they move as two. Those
    four people have 2.2 to 3.7, links from the pelvis to both hips of the dance 1.7 to 1.95."""
    length_within: float = 2.6
    """Length of a part farther out, at most, in radii. Of people 545 to 569, 1, 8, 12, humans, four-legged and random trees 0
    to 9 and of wave, dance and wolf (every fourth frame), two slices have 0.6 and 2.6, and mixtures of 2.2 and 2.4. Of true
    parts feet are the shortest, 1.3 and more, with mixtures of 4.0 and more; one has 2.4, and surfaces show the ball of that
    foot (`end_joints`). All others are 3.6 and more long."""
    mixture_within: float = 3.0
    """Mixture of a part farther out, at most."""
    least_alone: float = 1.5
    """Length of a slice on one side alone, at least: shorter ones `unpaired_parts` has judged already, and kept a true link
    from the pelvis to one hip of the dance (every fourth frame), which has 1.43. Three slices were seen, with 1.57, 2.6 and
    2.7."""
    longer: float = 1.6
    """How many times as long as a slice on one side alone the innermost part of its mirror image is, at least. Three were seen,
    with 2.4 to 4.2."""
    nearest: float = 0.55
    """Length of a part below which its two joints are one, if it is a mixture too (`mixture_within`), or lies farther out.
    Flesh above one hip of person 836, who runs, has 0.47, and about a knee of 884 0.36, where it is no mixture (3.3); links
    from a pelvis to a hip of recorded bodies have 0.66 and more."""
    shares: tuple[float, ...] = (0.3, 0.5, 0.7, 1.0, 1.4)
    """Distances from its outer joint, in that from its inner joint, below which a vertex goes to the limb, else to the trunk;
    of these the first with which the limb's joint drifts hardly more than with any. Chosen with `looser` on shoulders of the
    people who run, 1.2 % off then (1.7 with 0.5 for all), and of that body, 0.8 % off (2.5)."""
    most_drift: float = 0.7
    """Drift of the limb's joint without a slice, in radii of its border, at most: else the part is a bone. Upper arms of two
    four-legged bodies are as short as slices, and nearly mixtures; without them shoulder and elbow are one joint, which drifts
    by 0.93 to 0.98. Of 14 slices of people one has 0.47, half of an upper arm, the others 0.05 to 0.19."""
    looser: float = 1.3
    """Drift of the limb's joint, in the least, at most. The more of a slice goes to the limb, the farther inwards the joint
    lies, and the less it drifts until it is where the limb turns; from there on the drift hardly changes."""


class Slice(NamedTuple):
    """A part that is a slice.

    part, above : its place in the tree, and that of the part that it hangs on
    below       : those of the parts that hang on it
    inwards     : (vertex,) distance of every vertex from its outer joint, in that from its inner joint; infinite for those that
                  lie before the inner joint, and where there are several outer ones
    """

    part: int
    above: int
    below: tuple[int, ...]
    inwards: Floats


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
    of_pairs = list(mirrored_limbs(body.F, parts, pairs, paired))
    for limbs in of_pairs:
        if not len(limbs.one.part) or not len(limbs.other.part):
            continue
        touch = parts_touch(body.F, tree.label, int(limbs.one.part[-1]), int(limbs.other.part[-1]))
        limits = _of_touching(body, tree, limbs, confidence, chosen) if touch else chosen.apart
        for short in (_both(tree, limbs, limits), [] if touch else _one(tree, limbs, limits, chosen)):
            slices = [slice_between(body, tree, *limb.part[-2:].tolist()) for limb in short]
            if slices and all(_mixture(body, tree, each, confidence) <= limits.mixture for each in slices):
                found |= {each.part: each for each in slices}
                break
    for limb in (limb for limbs in of_pairs for limb in limbs[:2]):
        for each in (*_nearest(body, tree, limb, confidence, chosen), *_within(body, tree, limb, confidence, chosen)):
            if not found.keys() & {each.above, *each.below}:
                found[each.part] = each
    return [found[part] for part in sorted(found)]


def _of_touching(
    body: MovingSurface, tree: FirstTree, limbs: MirroredLimbs, confidence: Floats, chosen: MirroredSlicesSettings
) -> SliceLimits:
    """What slices of both limbs are at most, where their innermost parts touch each other."""
    if _left_by_one(body, tree, limbs, confidence) > chosen.as_two:
        return chosen.opposed
    short, long = sorted(_length(tree, limb) for limb in limbs[:2])
    is_unequal = chosen.longer_of_unequal * short <= long <= chosen.unequal.length
    return chosen.unequal if is_unequal else chosen.touching


def _left_by_one(body: MovingSurface, tree: FirstTree, limbs: MirroredLimbs, confidence: Floats) -> float:
    """What one motion leaves of the innermost parts of both limbs, in what a motion of its own leaves of each."""
    sides = np.array([limbs.one.part[-1], limbs.other.part[-1]])
    own = np.flatnonzero(np.isin(tree.label, sides))
    V, x, area = (np.ascontiguousarray(a, np.float64) for a in (body.V[own], body.x[:, own], body.area[own]))
    weight = np.asfortranarray(confidence[:, own], np.float64)
    left = list[float]()
    for label in (np.zeros(len(own), np.int64), (tree.label[own] == sides[1]).astype(np.int64)):
        count = int(label.max()) + 1
        R, t = np.empty((len(x), count, 3, 3)), np.empty((len(x), count, 3))
        fit(V, x, weight, area, label, np.ones(count, np.bool_), False, len(own), FIT_FLOOR * body.size**2, R, t)
        square = (residuals(V, x, weight * area, R, t, label) ** 2).mean(axis=0)
        left.append(float(np.sqrt(square @ np.bincount(label, area) / area.sum())))
    one, two = np.maximum(left, 1e-6 * body.size)
    return float(one / two)


def _nearest(
    body: MovingSurface, tree: FirstTree, limb: Limb, confidence: Floats, chosen: MirroredSlicesSettings
) -> Iterator[Slice]:
    """The innermost part of a limb, if its joints are one."""
    if _length(tree, limb) < chosen.nearest:
        one = slice_between(body, tree, *limb.part[-2:].tolist())
        if _mixture(body, tree, one, confidence) <= chosen.mixture_within:
            yield one


def _within(
    body: MovingSurface, tree: FirstTree, limb: Limb, confidence: Floats, chosen: MirroredSlicesSettings
) -> Iterator[Slice]:
    """The parts of a limb that are slices, its innermost and its last one left out.

    Beside another short part it is unknown which of the two is one.
    """
    rows = limb.part.tolist()
    for below, part, above in zip(rows, rows[1:], rows[2:], strict=False):
        length, beside = (_radii_long(tree, *two) for two in ((below, part), (part, above)))
        if length <= chosen.length_within < beside:
            one = slice_between(body, tree, below, part)
            if length < chosen.nearest or _mixture(body, tree, one, confidence) <= chosen.mixture_within:
                yield one


def _both(tree: FirstTree, limbs: MirroredLimbs, limits: SliceLimits) -> list[Limb]:
    """Both limbs, if their innermost parts are as short as slices, and alike."""
    short, long = sorted(_length(tree, limb) for limb in limbs[:2])
    return [*limbs[:2]] if limits.least <= long <= min(limits.length, limits.alike * short) else []


def _one(tree: FirstTree, limbs: MirroredLimbs, limits: SliceLimits, chosen: MirroredSlicesSettings) -> list[Limb]:
    """The limb whose innermost part alone is as short as a slice, if one of its two innermost joints has no partner."""
    lengths = [_length(tree, limb) for limb in limbs[:2]]
    side, (short, long) = int(np.argmin(lengths)), sorted(lengths)
    if not (chosen.least_alone <= short <= limits.length and chosen.longer * short <= long < np.inf):
        return []
    limb = (limbs.one, limbs.other)[side]
    last = len(limb.part) - 1
    return [limb] if np.isin([last - 1, last], limbs.row[:, side]).sum() == 1 else []


def _length(tree: FirstTree, limb: Limb) -> float:
    """Of a limb's innermost part, in radii; infinite where it is the last part too."""
    return np.inf if len(limb.part) < 2 else _radii_long(tree, *limb.part[-2:].tolist())


def _radii_long(tree: FirstTree, below: int, part: int) -> float:
    """Length of a part, from its joint to that of the part below, in radii; infinite where it carries two parts."""
    if (tree.parents == part).sum() != 1:
        return np.inf
    radius = max(float(min(tree.radius[part], tree.radius[below])), float(np.finfo(float).tiny))
    return float(np.linalg.norm(tree.rest[part] - tree.rest[below]) / radius)


def slice_between(body: MovingSurface, tree: FirstTree, below: int, part: int) -> Slice:
    """A part that may be a slice."""
    to_inner, to_outer = (body.V - tree.rest[k] for k in (part, below))
    inner, outer = (np.linalg.norm(away, axis=1) for away in (to_inner, to_outer))
    is_before = to_inner @ (tree.rest[below] - tree.rest[part]) <= 0.0
    inwards = np.where(is_before, np.inf, outer / np.maximum(inner, 1e-9 * body.size))
    return Slice(part, int(tree.parents[part]), (below,), inwards)


def _mixture(body: MovingSurface, tree: FirstTree, one: Slice, confidence: Floats) -> float:
    """What mixtures of the motions above and below a part leave of it, in what mixtures of its own with either leave; of parts
    with one below.

    Infinite where nothing of it is certain.
    """
    own, motions = tree.label == one.part, (one.above, one.part, one.below[0])
    if not confidence[:, own].any():
        return np.inf
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
