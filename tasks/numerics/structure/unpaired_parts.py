"""Parts of one limb that its mirror image lacks: rings of flesh, since joints come in pairs (ours).

A ring of flesh beside a joint is a part in one cut and none in the next, and in one limb of a pair and not in the other. So a
joint without a partner in the mirror image of its limb, close to one that has a partner, is no joint. A true part of the
trunk may carry one of two limbs in the tree alone: it moves the other limb as well as the part which that hangs on.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Ints
from kinetree.tasks.numerics.structure.joint_partners import PAIRED, MirroredLimbs, RootedParts, mirrored_limbs
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, PartTree
from kinetree.tasks.numerics.structure.rotation_centres import rotation_centres


class UnpairedPartsSettings(NamedTuple):
    """What makes a part with an unpaired joint flesh; lengths in radii of the smaller border. See RESULTS."""

    paired: float = PAIRED
    """See `joint_partners`."""
    near: float = 1.8
    """Distance of the unpaired joint from a paired one beside it, at most."""
    near_end: float = 1.25
    """The same of the outermost joint of a limb: the ball of a foot lies close to the ankle."""
    carries: float = 1.33
    """Drift of the mirrored limb's joint on a part of the trunk, in its drift where it hangs, below which that part carries
    both."""
    noise: float = 0.065
    """That drift, in radii of its border, below which the part carries both whatever it is where the limb hangs; not used where
    every vertex was followed. A slice of wave's pelvis has 0.060, flesh beside a shoulder of human 9 0.077."""


class _Slice(NamedTuple):
    """A part between an unpaired joint and a paired one.

    part     : its place in the tree
    distance : between the two joints, in radii of the smaller border
    on_trunk : whether it hangs on what carries both limbs
    mirrored : place of the innermost part of the other limb
    """

    part: int
    distance: float
    on_trunk: bool
    mirrored: int


def unpaired_parts(
    F: Ints, parts: MovingParts, found: PartTree, pairs: LimbPairs, settings: UnpairedPartsSettings | None = None
) -> Iterator[int]:
    """The parts that are likely rings of flesh, by their numbers, those whose joints lie nearest to each other first.

    F     : (face, corner)
    found : the tree of the parts
    """
    chosen = settings or UnpairedPartsSettings()
    limbs = mirrored_limbs(F, RootedParts.of(parts.label, found), pairs, chosen.paired)
    slices = [piece for pair in limbs for piece in _slices(found, pair, chosen)]
    for piece in sorted(slices, key=lambda s: (s.distance, s.part)):
        if not piece.on_trunk or not _carries_both(parts, found, piece, chosen):
            yield int(found.tree.order[piece.part])


def unpaired_joints(F: Ints, parts: RootedParts, pairs: LimbPairs, settings: UnpairedPartsSettings | None = None) -> int:
    """How many joints of all pairs of limbs have no partner; F (face, corner)."""
    paired = (settings or UnpairedPartsSettings()).paired
    return sum(int((~has).sum()) for limbs in mirrored_limbs(F, parts, pairs, paired) for has in _have_partners(limbs))


def _slices(found: PartTree, limbs: MirroredLimbs, chosen: UnpairedPartsSettings) -> Iterator[_Slice]:
    """The parts between an unpaired joint and a paired one near it, of both limbs of a pair."""
    parents, row, (one, other, _) = found.tree.parents, found.tree.border, limbs
    radius, rest = found.borders.radius[row], found.joints.rest[row]
    if not len(one.part) or not len(other.part):
        return
    for limb, mirror, has_partner in zip((one, other), (other, one), _have_partners(limbs), strict=True):
        for joint in np.flatnonzero(~has_partner).tolist():
            for beside in (joint - 1, joint + 1):
                if 0 <= beside < len(limb.part) and has_partner[beside]:
                    a, b = limb.part[[joint, beside]]
                    inner = max(joint, beside)
                    part = int(limb.part[inner])
                    distance = float(np.linalg.norm(rest[a] - rest[b]) / max(min(radius[a], radius[b]), np.finfo(float).tiny))
                    if (parents == part).sum() == 1 and distance < (chosen.near_end if joint == 0 else chosen.near):
                        yield _Slice(part, distance, inner == len(limb.part) - 1, int(mirror.part[-1]))


def _have_partners(limbs: MirroredLimbs) -> tuple[Flags, Flags]:
    """Which joints of two limbs have a partner."""
    flags = np.zeros(len(limbs.one.part), np.bool_), np.zeros(len(limbs.other.part), np.bool_)
    for has, row in zip(flags, limbs.row.T, strict=True):
        has[row] = True
    return flags


def _carries_both(parts: MovingParts, found: PartTree, piece: _Slice, chosen: UnpairedPartsSettings) -> bool:
    """Whether the mirrored limb might as well hang on the part: its joint drifts hardly more there than where it hangs, or by
    no more than aligned vertices err.
    """
    tree, row = found.tree, int(found.tree.border[piece.mirrored])
    limb, own, part = tree.order[[piece.mirrored, tree.parents[piece.mirrored], piece.part]]
    centre, radius = np.repeat(found.borders.centre[row][None], 2, axis=0), np.repeat(found.borders.radius[row], 2)
    pair = np.array([[limb, part], [limb, own]])
    on_part, on_own = rotation_centres(parts.R, parts.t, pair, centre, radius, parts.residual, parts.confidence).drift
    noise = 0.0 if parts.confidence is None else chosen.noise * radius[0]
    return bool(on_part < max(chosen.carries * on_own, noise))
