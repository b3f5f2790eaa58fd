"""How good the skeleton is against the truth, where the truth is known."""

from collections.abc import Mapping
from collections.abc import Sequence as Ordered
from typing import Any, NamedTuple

import numpy as np

from kinetree.errors import InputError
from kinetree.pipeline.task import task
from kinetree.schemas.array import Bools, Floats
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.evaluation import Chamfer, Evaluation, EvaluationParams, JointScore, Overlap, PartScore, Summary
from kinetree.schemas.results.truth import Truth
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.arrays import Ints
from kinetree.tasks.numerics.results.evaluation import body, rignet
from kinetree.tasks.numerics.results.evaluation.duplicates import branching, duplicated
from kinetree.tasks.numerics.results.evaluation.jitter import jitter
from kinetree.tasks.numerics.results.evaluation.lengths import length_variation
from kinetree.tasks.numerics.results.evaluation.matching import Matching, joint_errors, matching
from kinetree.tasks.numerics.results.evaluation.parts import (
    adjusted_rand_index,
    contingency,
    leading_parts,
    mean_iou,
    rand_index,
)
from kinetree.tasks.numerics.results.evaluation.rates import detection_rate, nearest_distance
from kinetree.tasks.numerics.results.evaluation.settings import EvaluationSettings
from kinetree.tasks.numerics.results.evaluation.split_joints import SplitTree, split_joints
from kinetree.tasks.numerics.results.evaluation.tree_edit import contracted_tree, remaining_ancestors, tree_edit_distance
from kinetree.tasks.numerics.results.evaluation.tree_match import tree_match_distance
from kinetree.tasks.numerics.results.units import unit_factor
from kinetree.tasks.results.truth import numbered, synthetic, true_carriers


class Comparison(NamedTuple):
    """A skeleton and its truth in the sequence's unit, frame by frame, with the partners of the true joints.

    X, Y                  : (frame, joint, xyz) joints of the skeleton, and joints of the truth as its file has them
    height                : of the body
    tree, matching, error : of the true joints after splitting: each carries one rigid group
    duplicated            : (spurious,) the true joint that each spurious joint is a second one of, −1 where it is none
    """

    skeleton: Skeleton
    truth: Truth
    X: Floats
    Y: Floats
    height: float
    tree: SplitTree
    matching: Matching
    error: Floats
    duplicated: Ints

    @property
    def is_tip(self) -> Bools:
        """(true,) which joints are tips."""
        return np.array([kind == "tip" for kind in self.truth.kinds])[self.tree.origin]


@task()
def evaluation(
    skeleton: Skeleton,
    truth: Truth,
    source: Mapping[int, Source],
    mesh: Mapping[int, Mesh],
    projection: Mapping[int, Projection],
    params: EvaluationParams,
) -> Evaluation:
    """Compares the skeleton with the truth: joints, tree, parts, lengths and smoothness (2014, Sec. 7.1)."""
    recipe = next((s.recipe for s in source.values()), "")
    if not truth.names and recipe:
        truth = synthetic(recipe)
    if not truth.names:
        none = np.zeros(len(skeleton.frames))
        return Evaluation(truth="", frames=skeleton.frames, unit=skeleton.unit, height=0.0, joints=(), spurious=(),
                          true_frames=0, summary=None, error=none[:, None][:, :0], detection=none, distance=none)  # fmt: skip
    truth = numbered(truth, source)
    compared = _comparison(skeleton, truth, params)
    rate, distance = (f(compared.X, compared.Y[:, _moving(truth)]) for f in (detection_rate, nearest_distance))
    of_frames_and_parts = {
        "detection": float(rate.mean()),
        "distance": float(distance.mean() / compared.height),
        "parts": _part_score(compared, source, mesh, projection),
    }
    return Evaluation(
        truth=truth.source,
        frames=skeleton.frames,
        true_frames=len(truth.frames),
        unit=skeleton.unit,
        height=compared.height,
        joints=tuple(_joint_score(compared, j) for j in range(len(compared.tree.parents))),
        spurious=tuple(skeleton.names[i] for i in compared.matching.spurious),
        duplicate_of=tuple(truth.names[compared.tree.origin[j]] if j >= 0 else "" for j in compared.duplicated),
        summary=_summary(compared, params).model_copy(update=of_frames_and_parts),
        error=compared.error,
        detection=rate,
        distance=distance / compared.height,
    )


def _comparison(skeleton: Skeleton, truth: Truth, params: EvaluationParams) -> Comparison:
    """Brings the truth to the sequence's frames and unit and matches the joints; refuses the truth of another sequence."""
    _check_frames(skeleton, truth)
    scale = unit_factor(truth.unit, skeleton.unit, truth.source)
    row = {frame: t for t, frame in enumerate(truth.frames)}
    Y = truth.positions[[row[frame] for frame in skeleton.frames]] * scale
    height = truth.height * scale if truth.height else body.longest_side(skeleton.vertices)
    is_joint = np.array([kind == "joint" for kind in skeleton.kinds])
    tree = split_joints(Y, truth.parents, truth.scored, height)
    is_tip = np.array([kind == "tip" for kind in truth.kinds])[tree.origin]
    partners = {"root": np.array(tree.parents) < 0, "joint": ~is_tip, "leaf": is_tip}  # a root is only matched with a root
    allowed = np.array([partners[kind] for kind in skeleton.kinds])
    X, Z = skeleton.positions, Y[:, tree.origin]
    limit = params.found * height
    pairs = matching(X, Z, allowed, scored=tree.scored | is_tip, can_be_spurious=is_joint, limit=limit)
    second = duplicated(X, Z, pairs.spurious, ~is_tip & (pairs.partner >= 0), limit)
    return Comparison(skeleton, truth, X, Y, height, tree, pairs, joint_errors(X, Z, pairs.partner), second)


def _check_frames(skeleton: Skeleton, truth: Truth) -> None:
    """Raises InputError where the truth lacks frames of the sequence or has another frame rate."""
    missing = [frame for frame in skeleton.frames if frame not in set(truth.frames)]
    if missing:
        raise InputError(
            f"{truth.source}: it has frames {truth.frames[0]} to {truth.frames[-1]}, but {len(missing)} of the"
            f" {len(skeleton.frames)} frames of the sequence are missing, the first is {missing[0]}; is it the truth of another"
            " sequence?"
        )
    tolerance = EvaluationSettings().rate_tolerance
    if truth.fps and skeleton.fps and abs(truth.fps / skeleton.fps - 1.0) > tolerance:
        raise InputError(
            f"{truth.source}: it has {truth.fps:g} frames a second, but the sequence has {skeleton.fps:g}; frames are compared"
            " by number, so resample the truth, or correct sequence.fps"
        )


def _moving(truth: Truth) -> Bools:
    """(true,) the joints that motion can show: the root, tips and scored joints."""
    rows = zip(truth.scored, truth.kinds, truth.parents, strict=True)
    return np.array([scored or kind == "tip" or parent < 0 for scored, kind, parent in rows])


def _dividing(c: Comparison) -> Bools:
    """(true,) the joints that divide the body into parts: the root, scored joints, and others that have a partner."""
    return ~c.is_tip & (c.tree.scored | (np.array(c.tree.parents) < 0) | (c.matching.partner >= 0))


def _joint_score(c: Comparison, j: int) -> JointScore:
    """The row of one true joint."""
    truth, partner, error, given = c.truth, int(c.matching.partner[j]), c.error[:, j], int(c.tree.origin[j])
    nearest, turns = float(c.matching.nearest[j]), float(truth.turns[given])
    of_partner: dict[str, Any] = {} if partner < 0 else {
        "found": c.skeleton.names[partner], "mean": float(error.mean()), "deviation": float(error.std()),
        "worst": float(error.max()), "percent": float(error.mean() / c.height * 100.0),
    }  # fmt: skip
    return JointScore(
        name=truth.names[given],
        kind=truth.kinds[given],
        scored=bool(c.tree.scored[j]),
        turns=turns if np.isfinite(turns) else None,
        nearest=nearest / c.height * 100.0 if np.isfinite(nearest) else None,
        **of_partner,
    )


def _summary(c: Comparison, params: EvaluationParams) -> Summary:
    """Counts and means over the joints, distances between the trees, lengths and jitter."""
    partner, scored = c.matching.partner, c.tree.scored
    hit = scored & (partner >= 0)
    mean = c.error[:, hit].mean(axis=0)
    of_error, of_truth = jitter(c.X[:, partner[hit]], c.Y[:, c.tree.origin[hit]], c.skeleton.frames)
    is_joint = np.array([kind == "joint" for kind in c.skeleton.kinds])
    excused = np.flatnonzero(~scored & ~c.is_tip & (partner >= 0))
    branches = branching(c.truth.parents)[c.tree.origin[c.duplicated[c.duplicated >= 0]]]
    of_tips = c.error[:, c.is_tip & (partner >= 0)]
    edit, shape = _tree_distances(c)
    return Summary(
        scored=int(scored.sum()),
        found=int(hit.sum()),
        close=int((mean <= params.close * c.height).sum()),
        missing=int((scored & ~hit).sum()),
        spurious=len(c.matching.spurious),
        branch_duplicates=int(branches.sum()),
        duplicates=int((c.duplicated >= 0).sum() - branches.sum()),
        false=int((c.duplicated < 0).sum()),
        excused=int(is_joint[partner[excused]].sum()),
        tips=int(c.is_tip.sum()),
        tips_found=of_tips.shape[1],
        tip_percent=float(of_tips.mean() / c.height * 100.0) if of_tips.size else None,
        error=float(mean.mean()) if hit.any() else None,
        percent=float(mean.mean() / c.height * 100.0) if hit.any() else None,
        deviation=float(c.error[:, hit].std(axis=0).mean()) if hit.any() else None,
        tree_edit=edit,
        tree_shape=shape,
        length_variation=float(length_variation(c.X, c.skeleton.parents).max(initial=0.0) * 100.0),
        true_length_variation=float(length_variation(c.Y, c.truth.parents).max(initial=0.0) * 100.0),
        jitter=of_error / of_truth if of_truth > 0.0 else None,
        jitter_percent=of_error / c.height * 100.0,
        **_rigging_scores(c),
    )


def _tree_distances(c: Comparison) -> tuple[int, int]:
    """Edit distances between the trees of joints: with the matching, and by the shape of the trees alone."""
    turning, dividing = np.array([kind != "leaf" for kind in c.skeleton.kinds]), _dividing(c)
    one, two = contracted_tree(c.skeleton.parents, list(turning)), contracted_tree(c.tree.parents, list(dividing))
    i, j = np.cumsum(turning) - 1, np.cumsum(dividing) - 1
    matched = np.flatnonzero(dividing & (c.matching.partner >= 0))
    numbers = [(int(i[c.matching.partner[k]]), int(j[k])) for k in matched]
    pairs = [(a, b) for a, b in numbers if one[a] >= 0 and two[b] >= 0]
    return tree_match_distance(one, two, pairs, c.tree.origin[dividing].tolist()), tree_edit_distance(one, two)


def _rigging_scores(c: Comparison) -> dict[str, Any]:
    """RigNet's measures, against all true joints and against those that motion can show."""
    moving, parents = _moving(c.truth), c.truth.parents
    tolerance, side = _radii_and_side(c)
    of_all = _rigging(c, c.Y, parents, side, tolerance)
    of_moving = _rigging(c, c.Y[:, moving], contracted_tree(parents, list(moving)), side, tolerance[moving])
    return {"chamfer": of_all[0], "chamfer_moving": of_moving[0], "overlap": of_all[1], "overlap_moving": of_moving[1]}


def _radii_and_side(c: Comparison) -> tuple[Floats, float]:
    """(true,) half the body's diameter at every true joint, median over the frames, and the side of the body's cube.

    raises : InputError where the true joints do not lie in the body
    """
    s = c.skeleton
    fits, radii = [], []
    for R, x, y in zip(s.rotation, c.X, c.Y, strict=True):
        V = body.blended_skin(s.vertices, s.influence, s.weight, s.rest, R, x)
        fits.append(body.joints_fit(V, y))
        radii.append(body.local_radii(V, y))
    if np.mean(fits) < EvaluationSettings().least_fitting:
        sizes = f"{body.longest_side(c.Y[0]):.4g}, but the body {body.longest_side(s.vertices):.4g}"
        raise InputError(
            f"{c.truth.source}: the true joints do not lie in the body: it is the truth of another sequence, or it has another"
            f" unit or other axes. The true joints measure {sizes}; if the unit differs, set truth.unit"
        )
    return np.median(radii, axis=0), body.longest_side(s.vertices)


def _rigging(c: Comparison, Y: Floats, parents: Ordered[int], side: float, tolerance: Floats) -> tuple[Chamfer, Overlap]:
    """RigNet's measures against some true joints."""
    distances = rignet.chamfer(c.X, c.skeleton.parents, Y, parents, side)
    shares = rignet.overlap(c.X, Y, tolerance)._asdict()
    return Chamfer(**distances._asdict()), Overlap(**{name: 100.0 * value for name, value in shares.items()})


def _part_score(
    c: Comparison, source: Mapping[int, Source], mesh: Mapping[int, Mesh], projection: Mapping[int, Projection]
) -> PartScore | None:
    """Agreement of the labels of the input's vertices in all frames with the true ones; None where these are not known."""
    s = c.skeleton
    part_of_joint = np.array(remaining_ancestors(s.parents, [kind != "leaf" for kind in s.kinds]))
    part = part_of_joint[leading_parts(s.label, s.influence, s.weight)]
    true_part = np.array(remaining_ancestors(c.tree.parents, list(_dividing(c))))
    labels, true_labels = [], []
    for frame in s.frames:
        carrier = None
        if frame in mesh:
            carrier = true_carriers(c.truth, source[frame], mesh[frame].vertices, frame, s.unit)
        if carrier is None:
            return None
        vertex, at = mesh[frame].vertex_of_input, projection[frame]
        known = (vertex >= 0) & (at.face >= 0)
        labels.append(part[s.faces[at.face[known], at.share[known].argmax(axis=1)]])
        joint, end = (values[vertex[known]] for values in carrier)
        true_labels.append(true_part[np.where(end >= 0, np.array(c.tree.parents)[end], joint)])
    table = contingency(np.concatenate(labels), np.concatenate(true_labels))
    return PartScore(
        rand=rand_index(table), adjusted_rand=adjusted_rand_index(table), mean_iou=mean_iou(table),
        parts=table.shape[0], true_parts=table.shape[1],
    )  # fmt: skip
