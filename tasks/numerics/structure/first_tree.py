"""The tree of a cut: which joints there are, before all cuts say where these lie (2014, Sec. 6.3; ours)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.cut_joints import cut_tree
from kinetree.tasks.numerics.structure.joint_consensus import JointMotion
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.part_tree import MovingSurface, PartTree
from kinetree.tasks.numerics.structure.pruning import NO_PART, Dropped
from kinetree.tasks.numerics.structure.rotation_centres import drift
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings, TreeJoints, both_residuals


class PartGraph(NamedTuple):
    """The parts before any was dropped, numbered as they were given.

    part           : (vertex,) part
    pair           : (border, 2) parts that meet
    centre         : (border, xyz) the point of the reference that the two turn about best, mesh unit
    border_drift   : (border,) root mean square distance between that point as its two parts carry it, mesh unit
    border_degrees : (border,) range of turning against each other, NaN for borders outside the spanning tree of all parts
    dropped        : parts that pruning dropped, in that order, and why
    """

    part: Ints
    pair: Ints
    centre: Floats
    border_drift: Floats
    border_degrees: Floats
    dropped: tuple[Dropped, ...]


class FirstTree(NamedTuple):
    """Parts in one tree, each with the joint about which it turns, in the tree's order: a part after its parent.

    parents       : (part,) −1 for the root
    place         : (given,) place in the tree of every part that was given, −1 for those dropped and those without vertices
    shown         : parts beyond joints that the frames' surfaces alone show, ascending
    label         : (vertex,) part
    W             : (vertex, part) skinning weights
    R, t          : (frame, part, 3, 3) · (frame, part, xyz) from the reference
    certain_share : (frame, part) share of its surface that is certain, 0 to 1; None where every vertex was followed
    rest          : (part, xyz) the joint in the reference, mesh unit
    drift         : (part,) distance between the joint as its two parts carry it, mesh unit; 0 for the root
    unexplained   : (frame, part) what the motion of the part leaves unexplained, mesh unit
    radius        : (part,) of the border at the joint, mesh unit; 0 for the root
    end_x         : (frame, end vertex, xyz) where the frames have the vertices of `at_ends`, mesh unit
    graph         : of all parts
    """

    parents: Ints
    place: Ints
    shown: tuple[int, ...]
    label: Ints
    W: Floats
    R: Floats
    t: Floats
    certain_share: Floats | None
    rest: Floats
    drift: Floats
    unexplained: Floats
    radius: Floats
    end_x: Floats
    graph: PartGraph

    @property
    def has_bones(self) -> bool:
        """Whether some of its parts are bones that no cut can find, see `hidden_bones`; or limbs that were cut off, see
        `limbs_apart`, where no cut has hidden bones.
        """
        return bool(len(self.parents) - len(self.shown) > (self.place >= 0).sum())

    @property
    def is_hidden(self) -> Flags:
        """(part,) whether a part is none of those that were given."""
        return ~np.isin(np.arange(len(self.parents)), self.place)

    @property
    def at_ends(self) -> Flags:
        """(vertex,) whether a vertex is of a part on either side of a joint that the frames' surfaces alone show."""
        beyond = np.array(self.shown, np.int64)
        return np.isin(self.label, np.append(beyond, self.parents[beyond]))

    def with_ends(self, body: MovingSurface) -> MovingSurface:
        """The body with its vertices where the frames have them, beside joints that these alone show."""
        x = body.x.copy()
        x[:, self.at_ends] = self.end_x
        return body._replace(x=x)

    @property
    def in_divided_trunk(self) -> Flags:
        """(part,) whether a part's joint is at a piece of the trunk, or of a limb cut off it, that surfaces alone show."""
        carrying = np.intersect1d(np.array(self.shown, np.int64), self.parents)
        return np.isin(np.arange(len(self.parents)), carrying) | np.isin(self.parents, carrying)

    @property
    def residual(self) -> Floats:
        """(part,) root mean square of what the motions of its two parts leave unexplained, mesh unit; 0 for the root."""
        return both_residuals(self.unexplained, self.parents)

    @property
    def motion(self) -> JointMotion:
        """Of the two parts at every joint but the root."""
        return JointMotion.of(self.R, self.t, self.parents, self.certain_share)

    def drift_at(self, rest: Floats) -> Floats:
        """(part,) the drift of joints elsewhere; rest (part, xyz) in the reference, mesh unit."""
        pair = np.stack([np.arange(1, len(rest)), self.parents[1:]], axis=1)
        return np.append(0.0, drift(self.R, self.t, pair, rest[1:], self.certain_share))


def first_tree(
    body: MovingSurface,
    cut: Cut,
    leaves: Ints,
    confidence: Floats | None = None,
    evidence: FrameEvidence | None = None,
    *,
    settings: KinematicTreeSettings,
) -> FirstTree:
    """Joins the parts of a cut in one tree, and drops those that are none; joints at ends are for `extended_tree` to find.

    leaves     : (leaf,) vertices at the ends of limbs
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    evidence   : the frames' surfaces, which must show every joint; None asks for no evidence
    """
    joints = cut_tree(body, cut, leaves, confidence, evidence, settings)
    return in_tree_order(joints, cut.R.shape[1])


def in_tree_order(joints: TreeJoints, parts: int) -> FirstTree:
    """The tree of a cut of so many parts."""
    left, tree = joints.left, joints.left.part_tree.tree
    origin, place = left.origin[tree.order], np.full(parts, -1)
    place[joints.used[origin[origin != NO_PART]]] = np.flatnonzero(origin != NO_PART)
    return FirstTree(
        parents=tree.parents,
        place=place,
        shown=(),
        label=joints.label,
        W=joints.W,
        R=joints.R,
        t=joints.t,
        certain_share=None if left.parts.confidence is None else left.parts.confidence[:, tree.order],
        rest=joints.rest,
        drift=joints.drift,
        unexplained=np.ascontiguousarray(left.parts.residual[:, tree.order]),
        radius=joints.radius,
        end_x=np.zeros((len(joints.R), 0, 3)),
        graph=_graph(joints),
    )


def in_reference(tree: FirstTree, cut: Cut, frame: int) -> FirstTree:
    """The tree of a cut in another pose as the same tree in the reference.

    tree  : without joints at ends
    cut   : of which it is the tree
    frame : position of the reference among the frames
    """
    R, t = _from(tree.R, tree.t, frame)
    root = tree.R[frame, 0] @ tree.rest[0] + tree.t[frame, 0]
    rest = np.concatenate([root[None], tree.motion.carried(tree.rest[1:])[frame]])
    moved, pair = tree._replace(R=R, t=t, rest=rest), tree.graph.pair
    sides = np.einsum("bsxy,by->bsx", cut.R[frame, pair], tree.graph.centre) + cut.t[frame, pair]
    centre = sides.mean(axis=1)
    graph = tree.graph._replace(centre=centre, border_drift=drift(*_from(cut.R, cut.t, frame), pair, centre))
    return moved._replace(drift=moved.drift_at(rest), graph=graph)


def _from(R: Floats, t: Floats, frame: int) -> tuple[Floats, Floats]:
    """Motions (frame, part, 3, 3) · (frame, part, xyz) from a frame instead of from the pose of a cut."""
    back = R @ R[frame].swapaxes(1, 2)
    return back, t - np.einsum("tpxy,py->tpx", back, t[frame])


def _graph(joints: TreeJoints) -> PartGraph:
    """All parts by the numbers that they were given."""
    before, used = joints.left.before, joints.used
    return PartGraph(
        part=joints.part,
        pair=used[before.borders.pair],
        centre=before.joints.rest,
        border_drift=before.joints.drift,
        border_degrees=_border_degrees(before),
        dropped=tuple(d._replace(part=int(used[d.part])) for d in joints.left.dropped),
    )


def _border_degrees(tree: PartTree) -> Floats:
    """(border,) range of turning across the borders of the tree, NaN across the others."""
    degrees = np.full(len(tree.borders.pair), np.nan)
    degrees[tree.tree.border[1:]] = tree.degrees[1:]
    return degrees
