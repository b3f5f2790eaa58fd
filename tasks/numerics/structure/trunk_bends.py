"""Joints of the trunk where the frames' surfaces bend it, with the borders of their parts (ours).

An alignment spreads the turn of a joint over the trunk, so that a cut's border may lie beside it, by a third of a radius or
more. The part beyond then holds flesh of the one before, and a ring across it shows a joint where none is. So before such a
ring counts, the joints that the cut has go to where the surfaces bend (`hinge_places`), and vertices on the way change sides.

That is certain only where halves of the frames bend each joint at the same place. Where a joint lies midway between two, or a
part holds one that the cut has not found, some frames bend it here and some there.
"""

from collections.abc import Collection, Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.close_joints import CLOSE
from kinetree.tasks.numerics.structure.end_rings import EndRing
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.hinge_costs import hinge_costs
from kinetree.tasks.numerics.structure.hinge_places import HingePlacesSettings, hinge_shifts, hinge_ways
from kinetree.tasks.numerics.structure.joint_partners import joints_between_pairs
from kinetree.tasks.numerics.structure.laid_parts import laid_frames
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.refitted_tree import refitted_tree
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence, rooted

OF_TRUNK = HingePlacesSettings(length=0.3, straight=0.4, gain=-np.inf, short_straight=0.4, short_gain=-np.inf)
"""What is asked of places: halves of the frames and both shapes of the border must agree on them. A gain is not asked for,
since a place between two of those that are tried leaves no less than these."""

SPREAD = 0.26
"""Largest distance between places of halves of the frames, radii, of joints that are where they turn. Seven people whose two
joints of the trunk are right but for their places have 0.02 to 0.24; person 606, in 24 frames of 3,000 vertices, whose lower
one is flesh of the hips, has 0.29; two humans whose cut has one of three and one midway have 0.97 and more at one of them."""

BOTH_SIDES = 0.25
"""How far on the other side of a joint some half of the frames bends the trunk than the others, radii, below which it is where
it turns all the same, if all joints that surfaces show are needed (`close_joints`), as that of 606 is not. People 842 and 850,
whose two are right, have 0; those two humans 0.6."""


def amid_two(extended: FirstTree, pairs: LimbPairs) -> list[int]:
    """Joints that surfaces show within a part of the trunk that lies between two of its joints, as between pelvis and chest.

    extended : a tree with joints that surfaces show
    """
    trunk = joints_between_pairs(rooted(extended), pairs)
    meet = _meeting(extended, trunk)
    return [k for k in extended.shown if k in trunk and min(meet[k], meet[extended.parents[k]]) > 1]


def roomy_rings(tree: FirstTree, rings: Sequence[EndRing], pairs: LimbPairs) -> list[EndRing]:
    """The rings without those that lie closer than `CLOSE` to a joint of their part, if this lies between two of the trunk.

    Where a short spine bends at both ends, all flesh between them bends, so that surfaces show a joint more amid them.
    """
    is_between = _meeting(tree, joints_between_pairs(rooted(tree), pairs)) > 1
    return [ring for ring in rings if not is_between[ring.cut.part] or ring.cut.apart >= CLOSE]


def with_joints_at_bends(
    body: MovingSurface, tree: FirstTree, joints: Collection[int], evidence: SurfaceEvidence, *, are_needed: bool = False
) -> FirstTree | None:
    """The tree with some of its joints, and the borders there, where the surfaces bend; None where halves of the frames do not
    agree on one of these joints.

    tree       : without joints that surfaces alone show
    joints     : by the parts that turn about them, not the root
    are_needed : see `BOTH_SIDES`
    """
    frames = laid_frames(len(body.x))
    if not len(frames):
        return None
    surfaces = {f: evidence.surface(f) for f in frames.tolist()}
    costs = hinge_costs(body.V, body.F, body.area, tree, surfaces, OF_TRUNK, joints)
    certain = np.ones((len(frames), len(tree.parents))) if tree.certain_share is None else tree.certain_share[frames]
    ways = hinge_ways(tree, costs, tree.rest, certain, OF_TRUNK)
    if not all(joint in ways and _is_settled(ways[joint] / tree.radius[joint], are_needed) for joint in joints):
        return None
    spans = [(frames >= first) & (frames < behind) for first, behind in score_spans(len(body.x), body.takes)]
    shifts = hinge_shifts(tree, costs, tree.rest, certain, spans, OF_TRUNK)
    moved = np.flatnonzero(shifts.any(axis=1))
    if not len(moved):
        return tree
    label = tree.label
    for joint in moved.tolist():
        label = _with_border_moved(body.V, label, tree, joint, shifts[joint])
    changed = sorted({*moved.tolist(), *tree.parents[moved].tolist()})
    return refitted_tree(body, tree._replace(label=label, rest=tree.rest + shifts), changed, evidence)


def _is_settled(ways: Floats, is_needed: bool) -> bool:
    """Whether halves of the frames agree on a joint, by ways in radii."""
    if not np.isfinite(ways).all():
        return False
    return bool(np.ptp(ways) < SPREAD or (is_needed and min(ways.max(), -ways.min()) < BOTH_SIDES))


def _with_border_moved(V: Floats, label: Ints, tree: FirstTree, joint: int, shift: Floats) -> Ints:
    """(vertex,) part; of the two that meet in a joint, those that the border passes change sides."""
    above, way = int(tree.parents[joint]), float(np.linalg.norm(shift))
    outwards = (V - tree.rest[joint]) @ shift / way
    far = V[tree.label == joint].mean(axis=0) - V[tree.label == above].mean(axis=0)
    loses, wins = (joint, above) if far @ shift > 0.0 else (above, joint)
    return np.where((label == loses) & (outwards < way), wins, label)


def _meeting(tree: FirstTree, joints: Ints) -> Ints:
    """(part,) how many of some joints each part has."""
    return np.bincount(np.concatenate([joints, tree.parents[joints]]), minlength=len(tree.parents))
