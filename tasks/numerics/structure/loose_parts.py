"""Parts under skin that bends everywhere, with a loose joint: moved anew as bones that blend with both neighbours (ours).

The vertices that follow such a part most follow its neighbours nearly as much, so that its rigid fit is their mixture, and its
joints drift. Weights of the skin and the motion of the part are found by turns (`blended_bone`), then again with both joints
kept together: without, the motion of a part that no vertex follows alone runs away.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.blended_bone import MovingSkin, blended_bone, refitted, refitted_about
from kinetree.tasks.numerics.structure.hidden_bones import (
    Border,
    HiddenBonesSettings,
    blend_joints,
    half_way,
    widest_blend_drift,
)
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import NO_PART
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.skinning import skinning
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints, both_residuals


class LoosePartsSettings(NamedTuple):
    """Which parts are moved anew; lengths are in radii of the borders at the part's two joints.

    Chosen on a dance; recorded bodies and people of odd seeds were kept apart.
    """

    drift: float = 0.12
    """Drift of either joint, at least. Loose parts drift by 0.13 and more; from 0.09 on necks that two bones share are moved
    too, and some get worse."""
    longest: float = 2.0
    """Distance between the joints, at most: a longer part has a rigid middle. Not varied."""
    shortest: float = 0.5
    """The same of the new joints, at least: what turns about one point is a ring of flesh. Not varied."""
    less_drift: float = 0.5
    """Drift of both new joints, share of that of the looser one, at most. Not varied; measured are 0.07 to 0.3."""
    rounds: int = 50
    """Rounds of weights and motion with both joints kept together. Not varied."""
    rounds_a_place: int = 5
    """Rounds after which the joints are placed anew. Not varied."""
    skin: HiddenBonesSettings = HiddenBonesSettings()
    """Which skin is looked at, and how it is fitted."""


class Chain(NamedTuple):
    """A part between two others.

    parts  : (3,) the part above, the part below, the part itself
    joint  : (side, xyz) with the part above and the part below, in the reference, mesh unit
    radius : (side,) of their borders, mesh unit
    drift  : (side,) of the joints in the take in which they drift most, mesh unit
    """

    parts: Ints
    joint: Floats
    radius: Floats
    drift: Floats

    @classmethod
    def of(cls, joints: TreeJoints, part: int, below: int, takes: Sequence[slice] | None) -> "Chain":
        """The part at a place of the tree, and the one below it; takes, see `score_spans`."""
        tree, places = joints.left.part_tree.tree, np.array([part, below])
        radius = joints.left.part_tree.borders.radius[tree.border[places]]
        parts = np.array([tree.parents[part], below, part])
        return cls(parts, joints.rest[places], radius, joints.widest_drift(takes)[places])

    def is_loose(self, chosen: LoosePartsSettings) -> bool:
        """Whether it is short and one of its joints drifts."""
        length = float(np.linalg.norm(self.joint[1] - self.joint[0]))
        return bool((self.drift > chosen.drift * self.radius).any() and length < chosen.longest * self.radius.min())


class TightPart(NamedTuple):
    """A part as it moves with both joints kept together.

    R, t     : (frame, 3, 3) · (frame, xyz) from the reference
    joint    : (side, xyz) with the part above and the part below, in the reference, mesh unit
    drift    : (side,) of these joints, mesh unit
    residual : (frame,) root mean square of what is left unexplained where the skin follows it, mesh unit
    """

    R: Floats
    t: Floats
    joint: Floats
    drift: Floats
    residual: Floats


def tightened(body: MovingSurface, joints: TreeJoints, noise: float, settings: LoosePartsSettings | None = None) -> TreeJoints:
    """The same tree; loose parts between two others move anew, where their joints drift less then, but for hidden bones.

    body  : every vertex of it was followed
    noise : error of a vertex below which its motion says nothing of its skinning weights, mesh unit
    """
    chosen, tree, before = settings or LoosePartsSettings(), joints.left.part_tree.tree, joints
    spans = score_spans(len(body.x), body.takes)
    for k in range(1, len(tree.order)):
        below, is_hidden = np.flatnonzero(tree.parents == k), joints.left.origin[tree.order[k]] == NO_PART
        if is_hidden or len(below) != 1 or not (chain := Chain.of(joints, k, int(below[0]), body.takes)).is_loose(chosen):
            continue
        skin = MovingSkin(body.V, body.x, body.area, joints.W, joints.R, joints.t)
        if (part := tight_part(skin, chain, spans, chosen)) is not None:
            joints = _moved(joints, chain, part)
    if joints is before:
        return joints
    weight = np.ones(body.x.shape[:2])
    return joints._replace(W=skinning(body.V, body.F, body.x, joints.label, joints.R, joints.t, tree.parents, weight, noise))


def tight_part(skin: MovingSkin, chain: Chain, spans: Ints, chosen: LoosePartsSettings) -> TightPart | None:
    """The motion of a part that explains the skin best with both joints kept together; None where they drift all the same.

    spans : (span, 2) frames over which the drift of joints is judged, see `score_spans`
    """
    of, size, above_below = chosen.skin, float(np.sqrt(skin.area.sum())), chain.parts[:2]
    reach = of.reach * np.maximum(chain.radius, of.narrow * size)
    close = (np.linalg.norm(skin.V[:, None] - chain.joint, axis=2) < reach).any(axis=1)
    near = np.flatnonzero(close & (skin.W[:, chain.parts].sum(axis=1) > of.skin))
    if len(near) < of.least_vertices:
        return None
    others = [p for p in np.argsort(-skin.W[near].sum(axis=0), kind="stable") if p not in chain.parts]
    parts = np.array([*above_below, *(p for p in others[: of.others] if skin.W[near, p].any()), chain.parts[2]])
    sample = near[np.linspace(0, len(near) - 1, min(of.most_vertices, len(near))).astype(np.int64)]
    few = skin.of(sample, parts, slice(None, None, -(-len(skin.x) // of.most_frames)))
    hold = (of.noise * size) ** 2
    fit, joint = _about_joints(_blended(few, chain, hold, of.rounds), chain.radius, hold, chosen)
    every = refitted(skin.of(sample, parts, slice(None))._replace(W=fit.W))
    for _ in range(3):
        every = refitted_about(every, joint)
    whole = skin.of(near, parts, slice(None))._replace(R=every.R, t=every.t).weighed(hold)
    residual = whole.bone_residual()
    new = blend_joints(whole, chain.radius, residual, of.prior)
    length = float(np.linalg.norm(new.rest[1] - new.rest[0]))
    drift = widest_blend_drift(whole, new.rest, spans).max()
    if drift > chosen.less_drift * chain.drift.max() or length < chosen.shortest * chain.radius.min():
        return None
    return TightPart(whole.R[:, -1], whole.t[:, -1], new.rest, new.drift, residual)


def _blended(few: MovingSkin, chain: Chain, hold: float, rounds: int) -> MovingSkin:
    """The better of two fits with free joints: begun from the part's motion, and from half-way between its neighbours."""
    R, t = few.R.copy(), few.t.copy()
    R[:, -1], t[:, -1] = half_way(few, Border(1, 0, chain.joint.mean(axis=0), float(chain.radius.mean()), 0.0))
    fits = [blended_bone(start, hold, rounds) for start in (few, few._replace(R=R, t=t))]
    return min(fits, key=lambda fit: float(fit.squares().mean()))


def _about_joints(fit: MovingSkin, radius: Floats, hold: float, chosen: LoosePartsSettings) -> tuple[MovingSkin, Floats]:
    """The fit with both joints kept together · (side, xyz) these joints."""
    joint = np.zeros((2, 3))
    for turn in range(chosen.rounds):
        if turn % chosen.rounds_a_place == 0:
            joint = blend_joints(fit, radius, fit.bone_residual(), chosen.skin.prior).rest
        fit = refitted_about(fit.weighed(hold), joint)
    return fit.weighed(hold), joint


def _moved(joints: TreeJoints, chain: Chain, part: TightPart) -> TreeJoints:
    """The tree with the part's new motion and joints; skinning weights are the old ones."""
    tree, parts, places = joints.left.part_tree.tree, joints.left.parts, chain.parts[[2, 1]]
    own, number = places[0], tree.order[places[0]]
    R, t, rest, drift = joints.R.copy(), joints.t.copy(), joints.rest.copy(), joints.drift.copy()
    R[:, own], t[:, own], rest[places], drift[places] = part.R, part.t, part.joint, part.drift
    by_number = parts.R.copy(), parts.t.copy(), parts.residual.copy()
    for array, new in zip(by_number, (part.R, part.t, part.residual), strict=True):
        array[:, number] = new
    moving = parts._replace(R=by_number[0], t=by_number[1], residual=by_number[2])
    both = both_residuals(moving.residual[:, tree.order], tree.parents)
    left = joints.left._replace(parts=moving)
    return joints._replace(left=left, R=R, t=t, rest=rest, drift=drift, residual=both)
