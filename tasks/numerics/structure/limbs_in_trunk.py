"""A limb that is one part with the trunk where its mirror image has a joint, cut at the level of that joint (ours).

In a squat both shanks turn by much and the pelvis by little, so that a cut may leave the pelvis and one thigh as one part. Such
a part follows the thigh, which costs the hip, and mostly the spine too. The other thigh tells how far from the end of the limb
the hip lies.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.joint_partners import PAIRED, Limb, RootedParts, mirrored_limbs
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, PartTree


class LimbsInTrunkSettings(NamedTuple):
    """When a limb lacks its innermost joint.

    Of 103 bodies (people 0 to 19, 60 to 69 and 86 to 114, humans and four-legged 0 to 4 and 60 to 69, random trees 60 to 69,
    wave, dance, ballet, wolf) nine have a thigh that is one part with the trunk.
    """

    inner: float = 0.7
    """Distance of the limb's own innermost joint from its end in that of the mirror image's, at most. Those nine have 0.56 to
    0.66; where the other limb has a joint too many, or lies on flesh beside the trunk, it is 0.77 and more. Of two joints that
    it lacks the outer one must lie farther inwards, in that of the inner one: person 815 has 0.93."""
    share: float = 0.3
    """Share of the part's surface that is of the limb, at least. Those have 0.51 to 0.90, others 0.07 to 0.50. Not varied."""
    least_vertices: int = 8
    """Vertices on either side of the cut, at least. Not varied."""


class LimbInTrunk(NamedTuple):
    """A part that is of a limb and of what it hangs on.

    part  : its number
    below : the next part of the limb
    limb  : (own,) its vertices that are of the limb
    """

    part: int
    below: int
    limb: Ints


def limbs_in_trunk(
    F: Ints,
    parts: MovingParts,
    found: PartTree,
    pairs: LimbPairs,
    area: Floats,
    settings: LimbsInTrunkSettings | None = None,
    paired: float = PAIRED,
) -> Iterator[LimbInTrunk]:
    """The parts that are of a limb and of what it hangs on.

    F      : (face, corner)
    found  : the tree of the parts
    pairs  : limbs that are mirror images
    area   : (vertex,) mesh unit²
    paired : radii, see `joint_partners.PAIRED`
    """
    chosen, tree = settings or LimbsInTrunkSettings(), found.tree
    limbs = mirrored_limbs(F, RootedParts.of(parts.label, found), pairs, paired)
    for away, (one, other, row) in zip(pairs.distance, limbs, strict=False):
        for side, (own, mirror) in enumerate(((one, other), (other, one))):
            level = _level_of_lacking(own, mirror, row[:, [side, 1 - side]], chosen)
            if level is not None:
                part, below = (int(tree.order[k]) for k in (tree.parents[own.part[-1]], own.part[-1]))
                inside = parts.label == part
                limb = inside & (away[side] < level) & (away[side] < away[1 - side])
                if _has_both(inside, limb, area, chosen):
                    yield LimbInTrunk(part, below, np.flatnonzero(limb))


def _level_of_lacking(own: Limb, mirror: Limb, partners: Ints, chosen: LimbsInTrunkSettings) -> float | None:
    """Distance from the end of the limb of the joint that its mirror image has farther inwards than any of its own; None where
    there is none. If there are two close to each other, on either side of flesh about a hip, the outer one counts.

    partners : (partners, 2) rows of joints of the limb and of its mirror image that are mirror images
    """
    last, of_last = len(own.part) - 1, partners[partners[:, 0] == len(own.part) - 1, 1]
    if last < 0 or len(of_last) != 1 or of_last[0] + 1 >= len(mirror.part):
        return None
    level, innermost = float(mirror.level[of_last[0] + 1]), float(mirror.level[-1])
    is_one = np.isfinite(innermost) and own.level[-1] <= chosen.inner * level and level > chosen.inner * innermost
    return level if is_one else None


def _has_both(inside: Flags, limb: Flags, area: Floats, chosen: LimbsInTrunkSettings) -> bool:
    """Whether a part has enough of the limb, and enough beside it."""
    sides, surface = (int(limb.sum()), int((inside & ~limb).sum())), float(area[limb].sum())
    return min(sides) >= chosen.least_vertices and surface > 0.0 and surface >= chosen.share * float(area[inside].sum())
