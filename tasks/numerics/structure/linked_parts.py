"""The tree with the bones that their length alone shows (ours).

Where a part's joint drifts and no skin shows a bone between it and the part above, as between pelvis and thigh, a link of
constant length is looked for (`rigid_links`). Where one part that hangs on another has a link, those of the parts beside it are
looked for at its mirror image, in the plane half-way between the two: both hips hang alike. Whether limbs are mirror images is
not asked.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.blended_bone import MovingSkin
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.hidden_bones import (
    Border,
    HiddenBone,
    HiddenBonesSettings,
    bone_of_skin,
    half_way,
    is_bone,
    parts_around,
    skin_around,
    widest_blend_drift,
)
from kinetree.tasks.numerics.structure.inserted_bones import InsertedRows
from kinetree.tasks.numerics.structure.joint_consensus import JointConsensus
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.rigid_links import (
    Between,
    RigidLink,
    RigidLinksSettings,
    likeliest_link,
    link_motion,
    rigid_link,
)
from kinetree.tasks.numerics.structure.rotation_centres import Joints, drift, widest_drift
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.skinning import skinning


class LinkedPartsSettings(NamedTuple):
    """Which parts are joined by a bone that no skin shows. Chosen on a dance, see `RigidLinksSettings`."""

    deviation: float = 0.1
    """Standard deviation of the link's length in drifts of the one joint, at most. The two true ones have less than 0.03 and
    between 0.05 and 0.1; with 0.4 no other is found."""
    mirror_spread: float = 0.25
    """Standard deviation of an end about the mirror image of the other part's, in radii of the border. That of the lower end is
    the joint that drifts. With 0.15 and with 1 the dance lacks one link, with 0.4 and 0.7 it has both."""
    link: RigidLinksSettings = RigidLinksSettings()
    skin: HiddenBonesSettings = HiddenBonesSettings()
    """What a bone must be, whether skin or its length shows it."""


class LinkedTree(NamedTuple):
    """A tree with the bones that length alone shows, and its joints as all cuts have them."""

    tree: FirstTree
    joints: JointConsensus


def with_rigid_links(
    body: MovingSurface, tree: FirstTree, joints: JointConsensus, noise: float, settings: LinkedPartsSettings | None = None
) -> LinkedTree:
    """A bone between a part and the one above wherever its length shows one; its joints are the tree's alone.

    body   : every vertex of it was followed
    tree   : without joints that the frames' surfaces alone show
    joints : (part,) of the tree, as all cuts have them
    noise  : error of a vertex below which its motion says nothing of its skinning weights, mesh unit
    """
    chosen = settings or LinkedPartsSettings()
    borders, links = _drifting(body, tree, joints.rest, chosen), dict[int, HiddenBone]()
    for k, border in borders.items():
        link = likeliest_link(_between(tree, border), border.joint, chosen.link)
        if (bone := _bone(body, tree, border, link, chosen)) is not None:
            links[k] = bone
    for k, border in borders.items():
        for sibling in [s for s in links if k not in links and borders[s].above == border.above]:
            expected = _mirrored(links[sibling].joint, border.joint)
            link = rigid_link(_between(tree, border), expected, chosen.mirror_spread, chosen.link.frames_alike)
            if (bone := _bone(body, tree, border, link, chosen)) is not None:
                links[k] = bone
                break
    return _with_links(body, tree, joints, dict(sorted(links.items())), noise) if links else LinkedTree(tree, joints)


def _between(tree: FirstTree, border: Border) -> Between:
    """How both parts move against each other."""
    above, below = _motion(tree, border.above), _motion(tree, border.part)
    noise = float(np.sqrt((tree.unexplained[:, [border.above, border.part]] ** 2).mean()))
    return Between.of(above, below, border.radius, noise)


def _motion(tree: FirstTree, part: int) -> tuple[Floats, Floats]:
    """(frame, 3, 3) · (frame, xyz) of a part."""
    return tree.R[:, part], tree.t[:, part]


def _mirrored(ends: Floats, joint: Floats) -> Floats:
    """(side, xyz) the mirror image of a link beside a part with a joint (xyz,): its lower end is that joint."""
    normal = joint - ends[1]
    normal /= max(float(np.linalg.norm(normal)), np.finfo(float).tiny)
    middle = (joint + ends[1]) / 2.0
    return np.asarray(ends - 2.0 * ((ends - middle) @ normal)[:, None] * normal)


def _drifting(body: MovingSurface, tree: FirstTree, rest: Floats, chosen: LinkedPartsSettings) -> dict[int, Border]:
    """Joints (part, xyz) of two parts that skin shows, which drift clearly, by the part below."""
    is_hidden, spans = tree.is_hidden, score_spans(len(body.x), body.takes)
    pair = np.stack([np.arange(1, len(rest)), tree.parents[1:]], axis=1)
    widest = np.append(0.0, widest_drift(tree.R, tree.t, pair, rest[1:], spans))
    clear = np.maximum(chosen.skin.clear_drift * tree.radius, chosen.skin.drift * body.size)
    shown = (widest > clear) & ~is_hidden & ~is_hidden[tree.parents]
    return {
        k: Border(k, int(tree.parents[k]), rest[k], float(tree.radius[k]), float(widest[k]))
        for k in np.flatnonzero(shown).tolist()
    }


def _bone(
    body: MovingSurface, tree: FirstTree, border: Border, link: RigidLink, chosen: LinkedPartsSettings
) -> HiddenBone | None:
    """The bone that a link is, with the skin that follows it; None where it is none."""
    skin = MovingSkin(body.V, body.x, body.area, tree.W, tree.R, tree.t)
    near = skin_around(skin, border, chosen.skin)
    is_long = link.length > chosen.skin.apart * border.radius
    if link.deviation > chosen.deviation * border.drift or not is_long or len(near) < chosen.skin.least_vertices:
        return None
    above, below = (_motion(tree, k) for k in (border.above, border.part))
    R, t = link_motion(above, below, link.ends, half_way(skin, border)[0])
    few = skin.of(near, parts_around(skin, border, near, chosen.skin), slice(None))
    whole = few.with_bone(R, t, 0.0).weighed((chosen.skin.noise * body.size) ** 2)
    last, spans = whole.R.shape[1] - 1, score_spans(len(body.x), body.takes)
    joints = Joints(link.ends, drift(whole.R, whole.t, np.array([[0, last], [1, last]]), link.ends))
    widest = widest_blend_drift(whole, link.ends, spans)
    bone = bone_of_skin(whole, near, joints, widest, spans, chosen.skin)
    return bone if is_bone(bone, border, body.size, chosen.skin) else None


def _with_links(
    body: MovingSurface, tree: FirstTree, joints: JointConsensus, links: Mapping[int, HiddenBone], noise: float
) -> LinkedTree:
    """The tree in its new order: every bone stands right before the part below it, by which it is given, ascending."""
    bones, below = list(links.values()), np.array(list(links))
    rows = InsertedRows.of(len(tree.parents), below)
    parents = np.full(len(tree.parents) + len(bones), -1)
    parents[rows.place] = np.where(tree.parents >= 0, rows.place[tree.parents], -1)
    parents[rows.own], parents[rows.own + 1] = parents[rows.own + 1], rows.own
    label = rows.place[tree.label]
    for k, bone in zip(rows.own, bones, strict=True):
        label[bone.skin] = k
    R, t, unexplained = (
        np.ascontiguousarray(rows.merged(a.swapaxes(0, 1), new).swapaxes(0, 1))
        for a, new in (
            (tree.R, [b.R for b in bones]),
            (tree.t, [b.t for b in bones]),
            (tree.unexplained, [b.residual for b in bones]),
        )
    )
    rest, alone = rows.both_sides(joints.rest, [b.joint for b in bones]), np.ones((len(bones), 2))
    linked = tree._replace(
        parents=parents,
        place=np.where(tree.place < 0, -1, rows.place[tree.place]),
        label=label,
        W=skinning(body.V, body.F, body.x, label, R, t, parents, np.ones(body.x.shape[:2]), noise),
        R=R,
        t=t,
        rest=rest,
        unexplained=unexplained,
        radius=rows.merged(tree.radius, [tree.radius[k] for k in below]),
    )
    spread, agreeing = (
        rows.both_sides(of, list(new * alone))
        for of, new in ((joints.spread, np.nan), (joints.agreeing.astype(np.float64), 1.0))
    )
    return LinkedTree(linked._replace(drift=linked.drift_at(rest)), JointConsensus(rest, spread, agreeing.astype(np.int64)))
