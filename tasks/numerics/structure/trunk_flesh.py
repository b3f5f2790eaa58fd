"""Flesh of the trunk that limbs of a pair hold, given back to it (ours)."""

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.limbs_apart import moving_by_themselves
from kinetree.tasks.numerics.structure.part_tree import MovingSurface, joints_of, part_tree
from kinetree.tasks.numerics.structure.pruning import Pruned
from kinetree.tasks.numerics.structure.wide_borders import wide_borders


def with_trunk_flesh(body: MovingSurface, state: Pruned, pairs: LimbPairs, confidence: Floats, paired: float) -> Pruned:
    """The parts and their tree with flesh of the trunk that limbs of a pair hold (`wide_borders`) as part of the trunk.

    As they are where a joint would go.

    pairs      : limbs that are mirror images
    confidence : (frame, vertex) 0 to 1
    paired     : radii, see `joint_partners.PAIRED`
    """
    parts, tree = state.parts, state.part_tree.tree
    label, changed = parts.label.copy(), set[int]()
    for flesh in wide_borders(body.V, body.F, RootedParts.of(parts.label, state.part_tree), pairs, paired):
        limb, trunk = int(tree.order[flesh.part]), int(tree.order[tree.parents[flesh.part]])
        label[flesh.vertex] = trunk
        changed |= {limb, trunk}
    if not changed:
        return state
    share = confident_share(label, body.area, confidence, len(body.x), parts.R.shape[1])
    joints = joints_of(state.part_tree)
    moved = moving_by_themselves(
        body, parts._replace(label=label, confidence=share, joined=joints), sorted(changed), confidence
    )
    found = part_tree(body, moved)
    return state._replace(parts=moved, part_tree=found) if joints_of(found) == joints else state
