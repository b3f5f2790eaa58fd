"""The finished body from its parts at once, as the tasks make it one after the other."""

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.cut_joints import cut_trees
from kinetree.tasks.numerics.structure.end_joints import EndJoint, EndJointsSettings, end_joints, judged_runs
from kinetree.tasks.numerics.structure.end_rings import EndFrames, EndRing, Fits, end_rings, laid_in_runs
from kinetree.tasks.numerics.structure.first_tree import FirstTree, first_tree
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.kinematic_tree import Derivation, KinematicTree, kinematic_tree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.shown_joints import with_end_joints
from kinetree.tasks.numerics.structure.tree_joints import NOISE, Cut, KinematicTreeSettings


def whole_tree(
    body: MovingSurface,
    cut: Cut,
    leaves: np.ndarray,
    confidence: np.ndarray | None = None,
    evidence: FrameEvidence | None = None,
    *,
    settings: KinematicTreeSettings,
    further: Sequence[Cut] = (),
    surface: Callable[[int], Target] | None = None,
    has_second_ends: bool = False,
    has_necks: bool = False,
    has_narrowings: bool = False,
    has_mirrored_joints: bool = False,
) -> tuple[KinematicTree, Derivation]:
    """The body, and how it came about; joints at ends are looked for where the frames' surfaces are given."""
    first = first_tree(body, cut, leaves, confidence, evidence, settings=settings)
    if surface is not None and confidence is not None:
        fits = fits_of_rings(body, first, confidence, surface)
        first = with_end_joints(body, first, leaves, fits, cache(surface), confidence, NOISE * body.size)
    cuts = [cut_trees(body, other, leaves, confidence, settings) for other in further]
    joints = [(cut.with_bones if first.has_bones else cut.bare) for cut in cuts]
    carried = [cut.motion.carried(cut.rest[1:]) for cut in joints]
    return kinematic_tree(
        body, first, leaves, confidence, further=carried, has_second_ends=has_second_ends, has_necks=has_necks,
        has_narrowings=has_narrowings, has_mirrored_joints=has_mirrored_joints,
    )  # fmt: skip


def joints_at_ends(
    body: MovingSurface,
    tree: FirstTree,
    confidence: np.ndarray,
    surface: Callable[[int], Target],
    settings: EndJointsSettings | None = None,
    mirrored: tuple[int, ...] = (),
) -> list[EndJoint]:
    """The joints at ends, judged in runs of frames as tasks judge them."""
    rings = end_rings(body.V, body.F, body.area, tree, np.isin(np.arange(len(tree.parents)), mirrored))
    fits, frames = _fits(body, tree, rings, confidence, surface, settings), _frames(body, tree, confidence, surface)
    return end_joints(frames, rings, fits, body.takes, settings)


def fits_of_rings(
    body: MovingSurface,
    tree: FirstTree,
    confidence: np.ndarray,
    surface: Callable[[int], Target],
    mirrored: tuple[int, ...] = (),
) -> list[Fits]:
    """How the parts of all rings lie in the judged frames."""
    rings = end_rings(body.V, body.F, body.area, tree, np.isin(np.arange(len(tree.parents)), mirrored))
    return _fits(body, tree, rings, confidence, surface, None)


def _fits(
    body: MovingSurface,
    tree: FirstTree,
    rings: Sequence[EndRing],
    confidence: np.ndarray,
    surface: Callable[[int], Target],
    settings: EndJointsSettings | None,
) -> list[Fits]:
    frames = _frames(body, tree, confidence, surface)
    return laid_in_runs(frames, judged_runs(len(body.x), body.takes, settings), rings)


def _frames(body: MovingSurface, tree: FirstTree, confidence: np.ndarray, surface: Callable[[int], Target]) -> EndFrames:
    return EndFrames.of(tree, body.area, np.arange(len(body.x)), confidence, cache(surface))
