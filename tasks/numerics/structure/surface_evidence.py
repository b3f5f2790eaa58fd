"""What the frames' surfaces say of a tree's rings, and what is known of it already (ours, see `end_joints`)."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.end_rings import EndFrames, EndRing, Fits, end_rings, laid_in_runs
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_partners import RootedParts, in_mirrored_limbs
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface


class SurfaceEvidence(NamedTuple):
    """What shows joints.

    surface    : gives a frame's surface, prepared, by its place among all frames
    confidence : (frame, vertex) 0 to 1
    noise      : see `extended_tree`
    """

    surface: Callable[[int], Target]
    confidence: Floats
    noise: float

    def frames(self, body: MovingSurface, tree: FirstTree) -> EndFrames:
        """All frames."""
        return EndFrames.of(tree, body.area, np.arange(len(body.x)), self.confidence, self.surface)


class KnownFits(NamedTuple):
    """How the parts of rings lie in the frames of `end_joints.judged_runs`, by where these rings lie: a tree that lost or won
    joints elsewhere has the same rings.
    """

    fits: dict[tuple[bytes, bytes], Fits]

    @classmethod
    def of(cls, rings: Sequence[EndRing], fits: Sequence[Fits]) -> "KnownFits":
        """By ring."""
        return cls({_place(ring): one for ring, one in zip(rings, fits, strict=True)})

    def laid(self, frames: EndFrames, runs: Sequence[Ints], rings: Sequence[EndRing]) -> list[Fits]:
        """By ring, each its own; those that are not known are laid, and known then."""
        new = [ring for ring in rings if _place(ring) not in self.fits]
        self.fits.update(zip(map(_place, new), laid_in_runs(frames, runs, new), strict=True))
        return [dict(self.fits[_place(ring)]) for ring in rings]


def _place(ring: EndRing) -> tuple[bytes, bytes]:
    return ring.cut.own.tobytes(), ring.cut.centre.tobytes()


def all_end_rings(V: Floats, F: Ints, area: Floats, tree: FirstTree, pairs: LimbPairs) -> list[EndRing]:
    """All rings of a tree, see `end_rings`."""
    return end_rings(V, F, area, tree, of_mirrored_limbs(tree, pairs), pairs)


def of_mirrored_limbs(tree: FirstTree, pairs: LimbPairs) -> Flags:
    """(part,) whether a part is of a limb that has a mirror image."""
    return in_mirrored_limbs(rooted(tree), pairs)


def rooted(tree: FirstTree) -> RootedParts:
    """Its parts alone."""
    return RootedParts(tree.label, tree.parents, tree.radius)
