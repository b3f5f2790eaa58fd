"""How good the skeleton is against the truth, where the truth is known."""

from collections.abc import Mapping
from collections.abc import Sequence as Ordered
from typing import Any, NamedTuple

import numpy as np

from kinetree.errors import InputError
from kinetree.pipeline.task import task
from kinetree.schemas.array import Bools, Floats
from kinetree.schemas.results.evaluation import Chamfer, Evaluation, EvaluationParams, JointScore, Overlap, PartScore, Summary
from kinetree.schemas.results.frame_truth import FrameTruth
from kinetree.schemas.results.known_truth import KnownTruth
from kinetree.schemas.results.truth import TrueBody
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
    mean_iou,
    rand_index,
)
from kinetree.tasks.numerics.results.evaluation.rates import detection_rate, nearest_distance
from kinetree.tasks.numerics.results.evaluation.settings import EvaluationSettings
from kinetree.tasks.numerics.results.evaluation.split_joints import SplitTree, split_joints
from kinetree.tasks.numerics.results.evaluation.tree_edit import contracted_tree, remaining_ancestors, tree_edit_distance
from kinetree.tasks.numerics.results.evaluation.tree_match import tree_match_distance
from kinetree.tasks.numerics.results.units import unit_factor


class Comparison(NamedTuple):
    """A skeleton and its truth in the sequence's unit, frame by frame, with the partners of the true joints.

    X, Y                  : (frame, joint, xyz) joints of the skeleton, and joints of the truth as its file has them
    height                : of the body
    tree, matching, error : of the true joints after splitting: each carries one rigid group
    duplicated            : (spurious,) the true joint that each spurious joint is a second one of, −1 where it is none
    """

    skeleton: Skeleton
    truth: TrueBody
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
    known_truth: KnownTruth,
    frame_truth: Mapping[int, FrameTruth],
    params: EvaluationParams,
) -> Evaluation:
    """Compares the skeleton with the truth: joints, tree, parts, lengths and smoothness (2014, Sec. 7.1)."""
    truth = known_truth
    if not truth.names:
        none = np.zeros(len(skeleton.frames))
        return Evaluation(truth="", frames=skeleton.frames, unit=skeleton.unit, height=0.0, joints=(), spurious=(),
                          true_frames=0, summary=None, error=none[:, None][:, :0], detection=none, distance=none)  # fmt: skip
    compared = _comparison(skeleton, truth, params)
    by_frame = [frame_truth[frame] for frame in skeleton.frames]
    rate, distance = (f(compared.X, compared.Y[:, _moving(truth)]) for f in (detection_rate, nearest_distance))
    of_frames_and_parts = {
        "detection": float(rate.mean()),
        "distance": float(distance.mean() / compared.height),
        "parts": _part_score(compared, by_frame),
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
        summary=_summary(compared, by_frame, params).model_copy(update=of_frames_and_parts),
        error=compared.error,
        detection=rate,
        distance=distance / compared.height,
    )


def _comparison(skeleton: Skeleton, truth: TrueBody, params: EvaluationParams) -> Comparison:
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


def _check_frames(skeleton: Skeleton, truth: TrueBody) -> None:
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


def _moving(truth: TrueBody) -> Bools:
    """(true,) the joints that motion can show: the root, tips and scored joints."""
    rows = zip(truth.scored, truth.kinds, truth.parents, strict=True)
    return np.array([scored or kind == "tip" or parent < 0 for scored, kind, parent in rows])


def _dividing(c: Comparison) -> Bools:
    """(true,) the joints that divide the body into parts: the root, scored joints, and others that have a partner."""
    return ~c.is_tip & (c.tree.scored | (np.array(c.tree.parents) < 0) | (c.matching.partner >= 0))


def _joint_score(c: Comparison, j: int) -> JointScore:
    """The row of one true joint."""
    truth, partner, error, origin = c.truth, int(c.matching.partner[j]), c.error[:, j], int(c.tree.origin[j])
    nearest, turns = float(c.matching.nearest[j]), float(truth.turns[origin])
    of_partner: dict[str, Any] = {} if partner < 0 else {
        "found": c.skeleton.names[partner], "mean": float(error.mean()), "deviation": float(error.std()),
        "worst": float(error.max()), "percent": float(error.mean() / c.height * 100.0),
    }  # fmt: skip
    return JointScore(
        name=truth.names[origin],
        kind=truth.kinds[origin],
        scored=bool(c.tree.scored[j]),
        turns=turns if np.isfinite(turns) else None,
        nearest=nearest / c.height * 100.0 if np.isfinite(nearest) else None,
        **of_partner,
    )


def _summary(c: Comparison, by_frame: Ordered[FrameTruth], params: EvaluationParams) -> Summary:
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
        **_rigging_scores(c, by_frame),
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


def _rigging_scores(c: Comparison, by_frame: Ordered[FrameTruth]) -> dict[str, Any]:
    """RigNet's measures, against all true joints and against those that motion can show."""
    moving, parents = _moving(c.truth), c.truth.parents
    tolerance, side = _radii_and_side(c, by_frame)
    of_all = _rigging(c, c.Y, parents, side, tolerance)
    of_moving = _rigging(c, c.Y[:, moving], contracted_tree(parents, list(moving)), side, tolerance[moving])
    return {"chamfer": of_all[0], "chamfer_moving": of_moving[0], "overlap": of_all[1], "overlap_moving": of_moving[1]}


def _radii_and_side(c: Comparison, by_frame: Ordered[FrameTruth]) -> tuple[Floats, float]:
    """(true,) half the body's diameter at every true joint, median over the frames, and the side of the body's cube.

    raises : InputError where the true joints do not lie in the body
    """
    s = c.skeleton
    if np.mean([frame.inside for frame in by_frame]) < EvaluationSettings().least_fitting:
        sizes = f"{body.longest_side(c.Y[0]):.4g}, but the body {body.longest_side(s.vertices):.4g}"
        raise InputError(
            f"{c.truth.source}: the true joints do not lie in the body: it is the truth of another sequence, or it has another"
            f" unit or other axes. The true joints measure {sizes}; if the unit differs, set truth.unit"
        )
    return np.median([frame.radius for frame in by_frame], axis=0), body.longest_side(s.vertices)


def _rigging(c: Comparison, Y: Floats, parents: Ordered[int], side: float, tolerance: Floats) -> tuple[Chamfer, Overlap]:
    """RigNet's measures against some true joints."""
    distances = rignet.chamfer(c.X, c.skeleton.parents, Y, parents, side)
    shares = rignet.overlap(c.X, Y, tolerance)._asdict()
    return Chamfer(**distances._asdict()), Overlap(**{name: 100.0 * value for name, value in shares.items()})


def _part_score(c: Comparison, by_frame: Ordered[FrameTruth]) -> PartScore | None:
    """Agreement of the labels of the input's vertices in all frames with the true ones; None where these are not known."""
    if not all(frame.known for frame in by_frame):
        return None
    s = c.skeleton
    part = np.array(remaining_ancestors(s.parents, [kind != "leaf" for kind in s.kinds]))
    true_part = np.array(remaining_ancestors(c.tree.parents, list(_dividing(c))))
    joint, carrier, end, count = (
        np.concatenate([getattr(frame, name) for frame in by_frame]) for name in ("part", "carrier", "bone_end", "count")
    )
    true = true_part[np.where(end >= 0, np.array(c.tree.parents)[end], carrier)]
    table = contingency(part[joint], true, count)
    return PartScore(
        rand=rand_index(table), adjusted_rand=adjusted_rand_index(table), mean_iou=mean_iou(table),
        parts=table.shape[0], true_parts=table.shape[1],
    )  # fmt: skip
