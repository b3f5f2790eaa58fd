"""Last parts of limbs, and the trunk, on the frames' surfaces, with a hinge at rings across them (ours, see `end_joints`)."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.end_cuts import EndCut, end_cuts
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings, confident_share
from kinetree.tasks.numerics.structure.hand_cuts import with_hand_rings
from kinetree.tasks.numerics.structure.hinged_piece import HingedFit, laid_as_one, laid_hinged, sampled_piece
from kinetree.tasks.numerics.structure.limb_cuts import limb_cuts
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS, LimbPairs
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFit, PiecePose
from kinetree.tasks.numerics.structure.trunk_cuts import TrunkCutsSettings, trunk_cuts

Fits = dict[int, HingedFit]
"""By frame, how a ring's part lies."""


class EndRing(NamedTuple):
    """A ring across the last part of a limb or across the trunk.

    piece       : points of its part
    is_mirrored : whether it lies across the end of a limb with a mirror image. There its hinge is also laid bent, see
                  `laid_hinged`; of heads, which have none, bent hinges found false joints
    """

    cut: EndCut
    piece: Piece
    is_mirrored: bool = False


class EndRings(NamedTuple):
    """How the parts of rings lie in some frames; nothing is said of a ring whose part a frame does not show.

    frame    : (frame,) places among all frames, ascending
    visible  : (frame, ring) whether the frame shows the ring's part
    one, two : (frame, ring) see `HingedFit`, mesh unit²
    rotation, translation, turn : (frame, ring, 3, 3) · (frame, ring, xyz) · (frame, ring, 3, 3) see `PiecePose`, mesh unit
    """

    frame: Ints
    visible: Flags
    one: Floats
    two: Floats
    rotation: Floats
    translation: Floats
    turn: Floats

    @staticmethod
    def of(frame: Ints, fits: Sequence[Fits]) -> "EndRings":
        """By ring and frame; frame (frame,) ascending."""
        shape, still = (len(frame), len(fits)), np.eye(3)
        out = EndRings(
            frame, np.zeros(shape, np.bool_), np.zeros(shape), np.zeros(shape),
            np.tile(still, (*shape, 1, 1)), np.zeros((*shape, 3)), np.tile(still, (*shape, 1, 1)),
        )  # fmt: skip
        for k, own in enumerate(fits):
            for row, f in enumerate(frame.tolist()):
                if f in own:
                    fit = own[f]
                    out.visible[row, k], out.one[row, k], out.two[row, k] = True, fit.one, fit.two
                    out.rotation[row, k], out.translation[row, k], out.turn[row, k] = fit.pose
        return out

    @staticmethod
    def joined(runs: Sequence["EndRings"]) -> "EndRings":
        """All frames of several runs, of one at least."""
        return EndRings(*(np.concatenate(rows) for rows in zip(*runs, strict=True)))

    @property
    def fits(self) -> list[Fits]:
        """By ring and frame."""
        frames = self.frame.tolist()
        return [
            {f: self._fit(row, k) for row, f in enumerate(frames) if self.visible[row, k]} for k in range(self.visible.shape[1])
        ]

    def _fit(self, row: int, k: int) -> HingedFit:
        pose = PiecePose(self.rotation[row, k], self.translation[row, k], self.turn[row, k])
        return HingedFit(float(self.one[row, k]), float(self.two[row, k]), pose)


class EndFrames(NamedTuple):
    """A tree, which of its parts some frames show, and the frames' surfaces.

    visible : by a frame's place among all frames, (part,) whether it shows the part
    surface : gives a frame's surface, prepared, by its place among all frames
    """

    tree: FirstTree
    visible: Mapping[int, Flags]
    surface: Callable[[int], Target]

    @staticmethod
    def of(tree: FirstTree, area: Floats, frame: Ints, confidence: Floats, surface: Callable[[int], Target]) -> "EndFrames":
        """Frames show a part where most of it and of the part that it hangs on is certain.

        area       : (vertex,) any unit
        frame      : (frame,) places of these frames among all
        confidence : (frame, vertex) in these frames, 0 to 1
        """
        share = confident_share(tree.label, area, confidence, len(confidence), len(tree.parents))
        visible = np.minimum(share, share[:, np.maximum(tree.parents, 0)]) >= FramePosesSettings().seen
        return EndFrames(tree, dict(zip(frame.tolist(), visible, strict=True)), surface)

    def goal(self, f: int, ring: EndRing) -> Floats:
        """(xyz,) where the rest of the body has the joint of the piece before a ring, mesh unit."""
        p = ring.cut.above
        return np.asarray(self.tree.R[f, p] @ ring.piece.joint + self.tree.t[f, p])

    def showing(self, which: Iterable[int], rings: Sequence[EndRing]) -> Iterator[tuple[int, Target, list[int]]]:
        """Frames that show some of the rings' parts, their surfaces, and which rings these are."""
        for f in map(int, which):
            there = [k for k, ring in enumerate(rings) if self.visible[f][_lower(self.tree, ring.cut)]]
            if there:
                yield f, self.surface(f), there


def end_rings(V: Floats, F: Ints, area: Floats, tree: FirstTree, mirrored: Flags, pairs: LimbPairs = NO_PAIRS) -> list[EndRing]:
    """All rings across the last parts of limbs, across the trunk, and across limbs that one part holds, part by part.

    V, F, area : (vertex, xyz) reference, mesh unit · (face, corner) · (vertex,) mesh unit²
    mirrored   : (part,) whether each is of a limb with a mirror image
    pairs      : limbs that are mirror images
    """
    N = smoothed_normals(V, F)
    of = (V, F, area, tree.label, tree.parents, tree.rest)
    across = with_hand_rings(V, F, area, tree, end_cuts(*of), pairs)
    at_ends = [_ring(V, N, tree, cut)._replace(is_mirrored=bool(mirrored[cut.part])) for cut in across]
    return [*at_ends, *(_ring(V, N, tree, cut) for cut in (*trunk_cuts(*of, mirrored), *limb_cuts(*of, pairs)))]


def closer_rings(
    V: Floats,
    F: Ints,
    area: Floats,
    tree: FirstTree,
    mirrored: Flags,
    parts: Collection[int],
    pairs: LimbPairs = NO_PAIRS,
) -> list[EndRing]:
    """Rings across some parts of the trunk that lie closer together, and across limbs that these hold; as in `end_rings`."""
    N, chosen = smoothed_normals(V, F), TrunkCutsSettings()
    chosen = chosen._replace(levels=chosen.closer_levels)
    of = (V, F, area, tree.label, tree.parents, tree.rest)
    cuts = (*trunk_cuts(*of, mirrored, chosen), *limb_cuts(*of, pairs))
    return [_ring(V, N, tree, cut) for cut in cuts if cut.part in parts]


def _ring(V: Floats, N: Floats, tree: FirstTree, cut: EndCut) -> EndRing:
    """A ring with points of its part, which hangs on the piece before it."""
    v, joint = cut.own, tree.rest[_lower(tree, cut)]
    return EndRing(cut, sampled_piece(V[v], N[v], tree.W[v, cut.part], cut.far, cut.centre, joint))


def _lower(tree: FirstTree, cut: EndCut) -> int:
    """Of a ring's part and the one above the ring that which hangs on the other."""
    return cut.part if tree.parents[cut.part] == cut.above else cut.above


def laid_in_runs(frames: EndFrames, runs: Iterable[Ints], rings: Sequence[EndRing]) -> list[Fits]:
    """By ring, how its part lies in the frames of some runs, each of which begins afresh."""
    fits = [Fits() for _ in rings]
    for run in runs:
        own = [Fits() for _ in rings]
        lay_rings(frames, run, rings, own)
        for known, new in zip(fits, own, strict=True):
            known.update(new)
    return fits


def lay_rings(frames: EndFrames, which: Ints, rings: Sequence[EndRing], fits: Sequence[Fits]) -> None:
    """Adds how the rings' parts lie in some frames, frame by frame, so that each begins where it was last.

    which : (frame,) places among the frames
    fits  : by ring
    """
    R, t = frames.tree.R, frames.tree.t
    for f, target, there in frames.showing(which, rings):
        whole: dict[tuple[int, ...], PieceFit] = {}
        for k in there:
            (cut, piece, is_mirrored), goal = rings[k], frames.goal(f, rings[k])
            of = (cut.part, cut.above, k) if cut.is_across_limb else (cut.part, cut.above)
            if of not in whole:
                start = PiecePose(R[f, cut.part], t[f, cut.part], np.eye(3))
                whole[of] = laid_as_one(piece, start, goal, target)
            fits[k][f] = laid_hinged(piece, whole[of], goal, target, _nearest(fits[k], f), is_bent=is_mirrored)


def _nearest(known: Fits, f: int) -> Floats | None:
    """(3, 3) the turn in the nearest frame that is known; None where none is."""
    return known[min(known, key=lambda g: (abs(g - f), g))].pose.Q if known else None
