"""How good the skeleton is against the truth, where somebody knows it."""

from collections.abc import Mapping
from collections.abc import Sequence as Ordered
from typing import NamedTuple

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
from kinetree.tasks.numerics.results.evaluation import body, rignet
from kinetree.tasks.numerics.results.evaluation.jitter import jitter
from kinetree.tasks.numerics.results.evaluation.lengths import length_variation
from kinetree.tasks.numerics.results.evaluation.matching import Matching, errors, matching
from kinetree.tasks.numerics.results.evaluation.meeting import Divided, divided
from kinetree.tasks.numerics.results.evaluation.parts import (
    adjusted_rand_index,
    contingency,
    leading_parts,
    mean_iou,
    rand_index,
)
from kinetree.tasks.numerics.results.evaluation.rates import detection_rate, nearest_distance
from kinetree.tasks.numerics.results.evaluation.tree_edit import contracted, kept_ancestors, tree_edit_distance
from kinetree.tasks.numerics.results.evaluation.tree_match import tree_match_distance
from kinetree.tasks.numerics.results.evaluation.truth import factor
from kinetree.tasks.results.truth import synthetic, true_carriers

SAME_RATE = 0.01
"""Frame rates that differ by less than this share are the same, rounded."""



class Sides(NamedTuple):
    """Both skeletons in the sequence's unit, frame by frame, and who is whose partner.

    Y is of the joints as the truth tells them; `tree`, `found` and `error` are of those that carry one rigid piece each.
    """

    skeleton: Skeleton
    truth: Truth
    X: Floats
    Y: Floats
    height: float
    tree: Divided
    found: Matching
    error: Floats

    @property
    def tip(self) -> Bools:
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
    sides = _sides(skeleton, truth, params)
    rate, distance = (f(sides.X, sides.Y[:, _moving(truth)]) for f in (detection_rate, nearest_distance))
    told = {
        "detection": float(rate.mean()),
        "distance": float(distance.mean() / sides.height),
        "parts": _parts(sides, source, mesh, projection),
    }
    return Evaluation(
        truth=truth.source,
        frames=skeleton.frames,
        true_frames=len(truth.frames),
        unit=skeleton.unit,
        height=sides.height,
        joints=tuple(_row(sides, j) for j in range(len(sides.tree.parents))),
        spurious=tuple(skeleton.names[i] for i in sides.found.spurious),
        summary=_summary(sides, params).model_copy(update=told),
        error=sides.error,
        detection=rate,
        distance=distance / sides.height,
    )


def _sides(skeleton: Skeleton, truth: Truth, params: EvaluationParams) -> Sides:
    """Brings the truth to the sequence's frames and unit, and matches; raises InputError where it is of another one."""
    missing = [frame for frame in skeleton.frames if frame not in set(truth.frames)]
    if missing:
        raise InputError(
            f"{truth.source}: it has frames {truth.frames[0]} to {truth.frames[-1]}, but not {len(missing)} of the"
            f" {len(skeleton.frames)} of the sequence, the first {missing[0]}; is it the truth of another sequence?"
        )
    if truth.fps and skeleton.fps and abs(truth.fps / skeleton.fps - 1.0) > SAME_RATE:
        raise InputError(
            f"{truth.source}: it has {truth.fps:g} frames a second and the sequence {skeleton.fps:g}; frames are compared by"
            " number, so resample the truth, or correct sequence.fps"
        )
    scale = factor(truth.unit, skeleton.unit, truth.source)
    at = {frame: t for t, frame in enumerate(truth.frames)}
    Y = truth.positions[[at[frame] for frame in skeleton.frames]] * scale
    height = truth.height * scale if truth.height else body.side(skeleton.vertices)
    is_joint = np.array([kind == "joint" for kind in skeleton.kinds])
    tree = divided(Y, truth.parents, truth.scored, height)
    tip = np.array([kind == "tip" for kind in truth.kinds])[tree.origin]
    pairs = {"root": np.array(tree.parents) < 0, "joint": ~tip, "leaf": tip}  # a root turns against nothing
    may = np.array([pairs[kind] for kind in skeleton.kinds])
    X, Z = skeleton.positions, Y[:, tree.origin]
    found = matching(X, Z, may, scored=tree.scored | tip, may_be_spurious=is_joint, limit=params.found * height)
    return Sides(skeleton, truth, X, Y, height, tree, found, errors(X, Z, found.partner))


def _moving(truth: Truth) -> Bools:
    """(true,) the joints that motion can show: root, tips and those that are scored."""
    told = zip(truth.scored, truth.kinds, truth.parents, strict=True)
    return np.array([s or kind == "tip" or p < 0 for s, kind, p in told])


def _seen(sides: Sides) -> Bools:
    """(true,) the joints that divide the body: root, scored ones, and others where a joint was found."""
    return ~sides.tip & (sides.tree.scored | (np.array(sides.tree.parents) < 0) | (sides.found.partner >= 0))


def _row(sides: Sides, j: int) -> JointScore:
    truth, partner, error, of = sides.truth, int(sides.found.partner[j]), sides.error[:, j], int(sides.tree.origin[j])
    nearest, turns = float(sides.found.nearest[j]), float(truth.turns[of])
    told = {} if partner < 0 else {
        "found": sides.skeleton.names[partner], "mean": float(error.mean()), "deviation": float(error.std()),
        "worst": float(error.max()), "percent": float(error.mean() / sides.height * 100.0),
    }  # fmt: skip
    return JointScore(
        name=truth.names[of],
        kind=truth.kinds[of],
        scored=bool(sides.tree.scored[j]),
        turns=turns if np.isfinite(turns) else None,
        nearest=nearest / sides.height * 100.0 if np.isfinite(nearest) else None,
        **told,
    )


def _summary(sides: Sides, params: EvaluationParams) -> Summary:
    """Counts and means; what needs the surface is added by others."""
    truth, found, height = sides.truth, sides.found, sides.height
    tip, scored = sides.tip, sides.tree.scored
    hit = scored & (found.partner >= 0)
    mean = sides.error[:, hit].mean(axis=0)
    rough, smooth = jitter(sides.X[:, found.partner[hit]], sides.Y[:, sides.tree.origin[hit]], sides.skeleton.frames)
    claims = np.array([kind == "joint" for kind in sides.skeleton.kinds])
    excused = np.flatnonzero(~scored & ~tip & (found.partner >= 0))
    moving = _moving(truth)
    edit, shape = _trees(sides)
    tolerance, side = _surface(sides)
    everything = _rigging(sides, sides.Y, truth.parents, side, tolerance)
    what_moves = _rigging(sides, sides.Y[:, moving], contracted(truth.parents, list(moving)), side, tolerance[moving])
    return Summary(
        scored=int(scored.sum()),
        found=int(hit.sum()),
        close=int((mean <= params.close * height).sum()),
        missing=int((scored & ~hit).sum()),
        spurious=len(found.spurious),
        excused=int(claims[found.partner[excused]].sum()),
        tips=int(tip.sum()),
        tips_found=int((tip & (found.partner >= 0)).sum()),
        error=float(mean.mean()) if hit.any() else None,
        percent=float(mean.mean() / height * 100.0) if hit.any() else None,
        deviation=float(sides.error[:, hit].std(axis=0).mean()) if hit.any() else None,
        chamfer=everything[0],
        chamfer_moving=what_moves[0],
        overlap=everything[1],
        overlap_moving=what_moves[1],
        tree_edit=edit,
        tree_shape=shape,
        length_variation=float(length_variation(sides.X, sides.skeleton.parents).max(initial=0.0) * 100.0),
        true_length_variation=float(length_variation(sides.Y, truth.parents).max(initial=0.0) * 100.0),
        jitter=rough / smooth if smooth > 0.0 else None,
        jitter_percent=rough / height * 100.0,
    )


def _trees(sides: Sides) -> tuple[int, int]:
    """Edits between the trees of joints, those that are the same known, and without looking where they are."""
    turning, seen = np.array([kind != "leaf" for kind in sides.skeleton.kinds]), _seen(sides)
    one, two = contracted(sides.skeleton.parents, list(turning)), contracted(sides.tree.parents, list(seen))
    i, j = np.cumsum(turning) - 1, np.cumsum(seen) - 1
    matched = [(int(i[sides.found.partner[k]]), int(j[k])) for k in np.flatnonzero(seen & (sides.found.partner >= 0))]
    pairs = [(a, b) for a, b in matched if one[a] >= 0 and two[b] >= 0]
    return tree_match_distance(one, two, pairs, sides.tree.origin[seen].tolist()), tree_edit_distance(one, two)


def _surface(sides: Sides) -> tuple[Floats, float]:
    """(true,) half the body's diameter at every true joint, median over the frames, and the side of the body's cube.

    raises : InputError where the true joints are not in the body
    """
    s = sides.skeleton
    fit, radius = [], []
    for R, x, y in zip(s.rotation, sides.X, sides.Y, strict=True):
        V = body.skinned(s.vertices, s.influence, s.weight, s.rest, R, x)
        fit.append(body.fits(V, y))
        radius.append(body.radii(V, y))
    if np.mean(fit) < 0.5:
        spans = f"true joints span {body.side(sides.Y[0]):.4g} and the body {body.side(s.vertices):.4g}"
        raise InputError(
            f"{sides.truth.source}: the true joints do not lie in the body as joints do: it is the truth of another sequence,"
            f" or in another unit or other axes; {spans}; say the unit with truth.unit"
        )
    return np.median(radius, axis=0), body.side(s.vertices)


def _rigging(sides: Sides, Y: Floats, above: Ordered[int], side: float, tolerance: Floats) -> tuple[Chamfer, Overlap]:
    """RigNet's measures against the true joints Y with their parents."""
    apart = rignet.chamfer(sides.X, sides.skeleton.parents, Y, above, side)
    shares = rignet.overlap(sides.X, Y, tolerance)._asdict()
    return Chamfer(**apart._asdict()), Overlap(**{name: 100.0 * value for name, value in shares.items()})


def _parts(
    sides: Sides, source: Mapping[int, Source], mesh: Mapping[int, Mesh], projection: Mapping[int, Projection]
) -> PartScore | None:
    """Labels of the user's own vertices in all frames, found and true; None where the true ones are not known."""
    s = sides.skeleton
    carries = np.array(kept_ancestors(s.parents, [kind != "leaf" for kind in s.kinds]))
    part = carries[leading_parts(s.label, s.influence, s.weight)]
    above = np.array(kept_ancestors(sides.tree.parents, list(_seen(sides))))
    labels, others = [], []
    for frame in s.frames:
        carrier = None
        if frame in mesh:
            carrier = true_carriers(sides.truth, source[frame], mesh[frame].vertices, frame, s.unit)
        if carrier is None:
            return None
        vertex, where = mesh[frame].vertex_of_input, projection[frame]
        known = (vertex >= 0) & (where.face >= 0)
        labels.append(part[s.faces[where.face[known], where.share[known].argmax(axis=1)]])
        joint, end = (side[vertex[known]] for side in carrier)
        others.append(above[np.where(end >= 0, np.array(sides.tree.parents)[end], joint)])
    table = contingency(np.concatenate(labels), np.concatenate(others))
    return PartScore(
        rand=rand_index(table), adjusted_rand=adjusted_rand_index(table), mean_iou=mean_iou(table),
        parts=table.shape[0], true_parts=table.shape[1],
    )  # fmt: skip
