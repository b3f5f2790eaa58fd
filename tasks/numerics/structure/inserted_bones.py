"""The tree with its hidden bones: each becomes a part between two others (ours)."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.blended_bone import MovingSkin
from kinetree.tasks.numerics.structure.hidden_bones import Border, HiddenBone, HiddenBonesSettings, hidden_bone
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree
from kinetree.tasks.numerics.structure.pruning import NO_PART
from kinetree.tasks.numerics.structure.rotation_centres import Borders, Joints
from kinetree.tasks.numerics.structure.skinning import skinning
from kinetree.tasks.numerics.structure.spanning_tree import RootedTree
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints, both_residuals


def inserted_bones(
    body: MovingSurface, found: TreeJoints, noise: float, settings: HiddenBonesSettings | None = None
) -> TreeJoints:
    """The same tree with a bone between a part and the one above wherever there is a hidden one.

    A joint of such a bone may hide another: a neck of two bones blends them both between chest and head.

    body  : every vertex of it was followed
    noise : error of a vertex below which its motion says nothing of its skinning weights, mesh unit
    """
    chosen = settings or HiddenBonesSettings()
    bones = _hidden_at(range(1, len(found.rest)), body, found, chosen)
    for _ in range(chosen.generations - 1):
        if not bones:
            break
        own = InsertedRows.of(len(found.rest), np.array(list(bones))).own.tolist()
        found = _extended(body, found, bones, noise)
        bones = _one_each(own, _hidden_at([k for o in own for k in (o, o + 1)], body, found, chosen))
    return _extended(body, found, bones, noise) if bones else found


def _one_each(own: Sequence[int], bones: dict[int, HiddenBone]) -> dict[int, HiddenBone]:
    """The same without the worse of two bones beside the same one, which stand for one bone between them."""
    worse = {max(o, o + 1, key=lambda k: bones[k].widest_drift.max()) for o in own if o in bones and o + 1 in bones}
    return {k: bone for k, bone in bones.items() if k not in worse}


def _hidden_at(
    joints: Iterable[int], body: MovingSurface, found: TreeJoints, chosen: HiddenBonesSettings
) -> dict[int, HiddenBone]:
    """The bones at some joints, ascending, each by the place of the part below it."""
    skin = MovingSkin(body.V, body.x, body.area, found.W, found.R, found.t)
    tree, met = found.left.part_tree.tree, found.left.part_tree.borders
    bones, drift = {}, found.widest_drift(body.takes)
    for k in joints:
        between = Border(k, int(tree.parents[k]), found.rest[k], float(met.radius[tree.border[k]]), float(drift[k]))
        if (bone := hidden_bone(skin, between, chosen, body.takes)) is not None:
            bones[k] = bone
    return bones


def _extended(body: MovingSurface, found: TreeJoints, bones: dict[int, HiddenBone], noise: float) -> TreeJoints:
    """The tree in its new order: every bone stands right before the part below it."""
    old, parts, new = found.left.part_tree, found.left.parts, list(bones.values())
    below = np.array(list(bones))
    rows = InsertedRows.of(len(old.tree.order), below)
    tree = _extended_tree(old, rows)
    label = rows.place[found.label]
    for k, bone in zip(rows.own, new, strict=True):
        label[bone.skin] = k
    R = np.ascontiguousarray(rows.merged(found.R.swapaxes(0, 1), [b.R for b in new]).swapaxes(0, 1))
    t = np.ascontiguousarray(rows.merged(found.t.swapaxes(0, 1), [b.t for b in new]).swapaxes(0, 1))
    residual = np.concatenate([parts.residual, np.stack([b.residual for b in new], axis=1)], axis=1)
    by_number = np.argsort(tree.order)
    moving = MovingParts(tree.order[label], R[:, by_number], t[:, by_number], residual, parts.confidence)
    borders, joints = _more_borders(old, below, new)
    degrees = rows.both_sides(old.degrees, [b.degrees for b in new])
    ratio = rows.both_sides(old.ratio, [b.ratio for b in new])
    left = found.left._replace(
        parts=moving,
        part_tree=PartTree(borders, joints, tree, degrees, ratio),
        origin=np.concatenate([found.left.origin, np.full(len(new), NO_PART)]),
    )
    W = skinning(body.V, body.F, body.x, label, R, t, tree.parents, np.ones(body.x.shape[:2]), noise)
    rest = rows.both_sides(found.rest, [b.joint for b in new])
    off = rows.both_sides(found.drift, [b.drift for b in new])
    both = both_residuals(residual[:, tree.order], tree.parents)
    return TreeJoints(left, found.used, found.part, label, W, R, t, rest, off, both)


class InsertedRows(NamedTuple):
    """Where rows of the old tree and of the bones stand in the new one.

    place : (part,) of every old part
    own   : (bone,) of every bone; the part below it is next
    """

    place: Ints
    own: Ints

    @classmethod
    def of(cls, parts: int, below: Ints) -> "InsertedRows":
        """Of a tree of so many parts; below (bone,) the part below each bone, ascending."""
        place = np.arange(parts) + np.searchsorted(below, np.arange(parts), side="right")
        return cls(place, place[below] - 1)

    def merged(self, old: Floats, new: Sequence[Floats]) -> Floats:
        """Rows of the old parts and of the bones."""
        out = np.empty((len(self.place) + len(self.own), *old.shape[1:]))
        out[self.place], out[self.own] = old, np.array(new)
        return out

    def both_sides(self, old: Floats, new: Sequence[Floats]) -> Floats:
        """Rows of the old parts; of each bone (side, …) its own towards the part above, then that of the part below it."""
        out = self.merged(old, [two[0] for two in new])
        out[self.own + 1] = np.array([two[1] for two in new])
        return out


def _extended_tree(old: PartTree, rows: InsertedRows) -> RootedTree:
    """Bones are numbered after all parts, their borders after all borders: with the part above, then with that below."""
    count, bones = len(old.tree.order), np.arange(len(rows.own))
    parents, border, order = (np.full(count + len(bones), -1) for _ in range(3))
    parents[rows.place] = np.where(old.tree.parents >= 0, rows.place[old.tree.parents], -1)
    parents[rows.own], parents[rows.own + 1] = parents[rows.own + 1], rows.own
    border[rows.place] = old.tree.border
    border[rows.own] = len(old.borders.pair) + 2 * bones
    border[rows.own + 1] = border[rows.own] + 1
    order[rows.place], order[rows.own] = old.tree.order, count + bones
    return RootedTree(order, parents, border)


def _more_borders(old: PartTree, below: Ints, new: Sequence[HiddenBone]) -> tuple[Borders, Joints]:
    """Two more borders a bone, as wide as the one between the part above it and the part below it (bone,)."""
    tree, met = old.tree, old.borders
    row, number = tree.border[below], len(tree.order) + np.arange(len(new))
    sides = np.stack([tree.order[tree.parents[below]], tree.order[below]], axis=1)
    pair = np.stack([sides, np.tile(number[:, None], (1, 2))], axis=2).reshape(-1, 2)
    joint = np.concatenate([b.joint for b in new])
    borders = Borders(
        np.concatenate([met.pair, pair]),
        np.concatenate([met.centre, joint]),
        np.concatenate([met.radius, np.repeat(met.radius[row], 2)]),
        np.concatenate([met.length, np.repeat(met.length[row], 2)]),
    )
    rest, off = old.joints
    return borders, Joints(np.concatenate([rest, joint]), np.concatenate([off, *(b.drift for b in new)]))
