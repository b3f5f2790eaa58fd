"""The tree of the rigid parts that pruning leaves, and its joints, as one cut of the body gives them (2014, Sec. 6.3)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.centre_lines import towards_centre_lines
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.joint_consensus import JointMotion
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.limb_pairs import limb_pairs
from kinetree.tasks.numerics.structure.limbs_apart import with_limbs_apart
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface
from kinetree.tasks.numerics.structure.pruning import Pruned, PruningSettings, pruned, without_flesh
from kinetree.tasks.numerics.structure.rigid_cores import core_motions
from kinetree.tasks.numerics.structure.root_place import root_amid_limbs
from kinetree.tasks.numerics.structure.rotation_centres import RotationCentresSettings, rotation_centres, widest_drift
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.skinning import skinning
from kinetree.tasks.numerics.structure.trunk_flesh import with_trunk_flesh

NOISE = 0.002
"""Error of a vertex below which its motion says nothing of its skinning weights, share of the root of the area. Not recorded.
Joints move by 0.3 % of the height at most when it is halved or doubled."""


class KinematicTreeSettings(NamedTuple):
    """How parts become joints; lengths are shares of the root of the area where nothing else is said."""

    pruning: PruningSettings
    """What a joint must show to stay."""
    noise: float = NOISE
    spread: float = 0.35
    """Standard deviation of a joint about where it is expected, in radii of its border. Not recorded; see DESIGN for what
    the expected place was chosen on. Joints move by 2 % of the height at most when it is halved
    or doubled, errors by 0.14 %."""
    across: float = 0.12
    """The same across the centre line of a long part; lines of recorded bodies pass their joints at 0.1 to 0.2. Chosen with
    `along`; see RESULTS for the bodies and other values."""
    along: float = 0.5
    """The same along that line."""
    frames_alike: float = 3.0
    """Frames that err alike even where neighbours do not: what is wrong in one pose is wrong in the next like it. Not
    recorded. Joints move by 1.3 % of the height at most when it is halved or doubled, errors by 0.06 %."""
    far: float = 0.7
    """Distance from where it is expected, in radii of its border, at which a joint is held twice as firmly. Chosen on
    heads, whose joints run away along the axis by two radii. Joints move by 0.4 % of the height at most when it is halved
    or doubled."""
    residual_share: float = 0.5
    """Share of what a part's motion leaves of single vertices that its motion may err by: noise averages out over a part.
    Not recorded. Joints move by 0.1 % of the height at most when it is halved or doubled."""
    hidden_bones: bool = False
    """Whether bones under skin that is nowhere rigid are looked for where every vertex was followed, see `hidden_bones`."""
    root_amid_limbs: bool = False
    """Whether the root lies amid the limbs that hang on it, see `root_place`, and not amid its surface."""


class Cut(NamedTuple):
    """The body cut into rigid parts in one of its poses.

    V        : (vertex, xyz) that pose, mesh unit
    label    : (vertex,) rigid part, −1 for none
    R, t     : (frame, part, 3, 3), (frame, part, xyz) from that pose to each frame
    residual : (frame, part) what a part's motion leaves unexplained, mesh unit
    """

    V: Floats
    label: Ints
    R: Floats
    t: Floats
    residual: Floats


class TreeJoints(NamedTuple):
    """A tree of joints; but for `used`, `part` and `left`, parts are in the tree's order.

    left     : the parts that are left, and their tree
    used     : (part,) number of each part before pruning, as it was given
    part     : (vertex,) part before pruning, as it was given; vertices without one have that of the nearest with one
    label    : (vertex,) part
    W        : (vertex, part) skinning weights
    R, t     : (frame, part, 3, 3) · (frame, part, xyz) from the reference
    rest     : (part, xyz) the joint about which each part turns, in the reference, mesh unit
    drift    : (part,) distance between the joint as its two parts carry it, mesh unit; 0 for the root
    residual : (part,) root mean square of what the motions of its two parts leave unexplained, mesh unit; 0 for the root
    """

    left: Pruned
    used: Ints
    part: Ints
    label: Ints
    W: Floats
    R: Floats
    t: Floats
    rest: Floats
    drift: Floats
    residual: Floats

    @property
    def radius(self) -> Floats:
        """(part,) of the border with the parent, mesh unit; 0 for the root."""
        found = self.left.part_tree
        return np.append(0.0, found.borders.radius[found.tree.border[1:]])

    @property
    def motion(self) -> JointMotion:
        """Of the two parts at every joint but the root."""
        tree, seen = self.left.part_tree.tree, self.left.parts.confidence
        return JointMotion.of(self.R, self.t, tree.parents, None if seen is None else seen[:, tree.order])

    def widest_drift(self, takes: Sequence[slice] | None) -> Floats:
        """(part,) `drift` over all frames or within the take where it is largest, mesh unit; every vertex was followed.

        takes : positions of the frames of each take; None takes all as one
        """
        spans = score_spans(len(self.R), takes)
        if len(spans) == 1:
            return self.drift
        part = np.arange(1, len(self.rest))
        pair = np.stack([part, self.left.part_tree.tree.parents[part]], axis=1)
        return np.append(0.0, widest_drift(self.R, self.t, pair, self.rest[part], spans))


def tree_joints(
    body: MovingSurface,
    cut: Cut,
    leaves: Ints,
    confidence: Floats | None = None,
    evidence: FrameEvidence | None = None,
    *,
    settings: KinematicTreeSettings,
) -> TreeJoints:
    """Joins the parts of a cut in one tree, drops those that are none, and places the joints.

    body       : its reference is the pose of the cut
    leaves     : (leaf,) vertices at the ends of limbs
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    evidence   : the frames' surfaces, which must show every joint; None asks for no evidence
    """
    label = _filled(body.V, np.array(cut.label, dtype=np.int64))
    used, label, R, t, residual = _used(label, cut.R, cut.t, cut.residual)
    seen = None if confidence is None else confident_share(label, body.area, confidence, len(body.x), R.shape[1])
    parts = MovingParts(label, R, t, residual, seen)
    pairs = limb_pairs(body.V, body.F, leaves)
    left = pruned(body, parts, leaves, evidence, settings=settings.pruning, pairs=pairs)
    if confidence is not None:
        paired = settings.pruning.unpaired.paired
        left = with_limbs_apart(body, left, leaves, pairs, confidence, paired)
        left = with_trunk_flesh(body, left, pairs, confidence, paired)
    return tree_of_parts(body, left, used, used[label], confidence, settings)


def without_part(body: MovingSurface, found: TreeJoints, part: int, settings: KinematicTreeSettings) -> TreeJoints:
    """The tree without a part that is flesh, by its number among those that are left; every vertex of the body was followed."""
    return tree_of_parts(body, without_flesh(body, found.left, part), found.used, found.part, None, settings)


def tree_of_parts(
    body: MovingSurface, left: Pruned, used: Ints, part: Ints, confidence: Floats | None, chosen: KinematicTreeSettings
) -> TreeJoints:
    """The joints of the parts that are left.

    used, part : see `TreeJoints`
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    """
    V, F, x, area, _ = body
    tree = left.part_tree.tree
    label = np.argsort(tree.order)[left.parts.label]
    tau = np.ones(x.shape[:2]) if confidence is None else np.array(confidence, dtype=np.float64)
    if confidence is None:
        left = left._replace(parts=_by_cores(body, left.parts))
    R, t = (np.ascontiguousarray(a[:, tree.order]) for a in (left.parts.R, left.parts.t))
    W = skinning(V, F, x, label, R, t, tree.parents, tau, chosen.noise * body.size)
    rest, off = _joints(V, area, label, W, left, chosen)
    both = both_residuals(left.parts.residual[:, tree.order], tree.parents)
    return TreeJoints(left, used, part, label, W, R, t, rest, off, both)


def _by_cores(body: MovingSurface, parts: MovingParts) -> MovingParts:
    """The same parts; those that have a core move as it does."""
    R, t, residual = core_motions(body.V, body.x, body.area, parts.label, parts.R, parts.t, parts.residual)
    return parts._replace(R=R, t=t, residual=residual)


def both_residuals(residual: Floats, parents: Ints) -> Floats:
    """(part,) root mean square of what the motions of a part and its parent leave unexplained; 0 for the root.

    residual : (frame, part) mesh unit
    parents  : (part,) −1 for the root
    """
    square = (residual**2).mean(axis=0)
    return np.where(parents < 0, 0.0, np.sqrt((square + square[np.maximum(parents, 0)]) / 2))


def _joints(
    V: Floats, area: Floats, label: Ints, W: Floats, left: Pruned, chosen: KinematicTreeSettings
) -> tuple[Floats, Floats]:
    """Joints in the tree's order, expected amid their border or on centre lines, and their drift.

    Where every vertex was followed lines say where joints are expected, but hold none more firmly: motion is surer.
    """
    parts, tree, met = left.parts, left.part_tree.tree, left.part_tree.borders
    rest, off = np.empty((len(tree.order), 3)), np.zeros(len(tree.order))
    root = label == 0
    rest[0] = area[root] @ V[root] / area[root].sum()
    rows = tree.border[1:]
    expected = towards_centre_lines(V, area, label, W, tree.parents, met.centre[rows], met.radius[rows])
    pair = np.stack([tree.order[1:], tree.order[tree.parents[1:]]], axis=1)
    residual = chosen.residual_share * parts.residual
    prior = RotationCentresSettings(
        spread=chosen.spread, across=chosen.across, along=chosen.along, frames_alike=chosen.frames_alike, far=chosen.far
    )
    lines = None if parts.confidence is None else expected.lines
    place, radius = expected.place, met.radius[rows]
    joints = rotation_centres(parts.R, parts.t, pair, place, radius, residual, parts.confidence, prior, lines)
    rest[1:], off[1:] = joints.rest, joints.drift
    if chosen.root_amid_limbs:
        rest[0] = root_amid_limbs(rest, tree.parents, rest[0])
    return rest, off


def _filled(V: Floats, label: Ints) -> Ints:
    """Vertices without a part have that of the nearest vertex with one."""
    missing = label < 0
    if not missing.any():
        return label
    if missing.all():
        return np.zeros_like(label)
    filled = label.copy()
    filled[missing] = label[~missing][KDTree(V[~missing]).query(V[missing])[1]]
    return filled


def _used(label: Ints, *of_parts: Floats) -> tuple[Ints, Ints, Floats, Floats, Floats]:
    """(part,) the parts that some vertex has · labels and arrays of these parts alone."""
    used, label = np.unique(label, return_inverse=True)
    R, t, residual = (np.ascontiguousarray(a[:, used], dtype=np.float64) for a in of_parts)
    return used, label.astype(np.int64), R, t, residual
