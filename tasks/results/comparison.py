"""Two skeletons of the same sequence compared, with the truth where it is known."""

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from kinetree.errors import InputError
from kinetree.schemas.array import Floats
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.comparison import (
    ComparedRun,
    Comparison,
    JointPair,
    ParameterDifference,
    TrueJoint,
    UnpairedJoint,
)
from kinetree.schemas.results.evaluation import Evaluation, JointScore
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results.comparison import (
    BOX_TOLERANCE,
    allowed_distances,
    box_difference,
    mutual_nearest,
    pair_distances,
)
from kinetree.tasks.numerics.results.evaluation.body import longest_side

Frames = tuple[Mapping[int, Source], Mapping[int, Mesh]]
"""Sources and cleaned meshes by source frame number."""
KINDS = ("joint", "leaf", "root")
"""The order in which joints of one run alone are listed."""
MESH_KINDS = ("file", "npz", "zarr", "synth")
"""Kinds of source whose vertices are the user's own."""


def compared_run(name: str, method: str, skeleton: Skeleton, evaluation: Evaluation | None, seconds: float) -> ComparedRun:
    """The figures of one run.

    evaluation : against the truth of both runs; None where there is none
    seconds    : that computing the skeleton took
    """
    summary = evaluation.summary if evaluation else None
    scores = {name: getattr(summary, name) for name in ("scored", "found", "spurious", "error", "percent")} if summary else {}
    return ComparedRun(
        name=name,
        method=method,
        joints=skeleton.kinds.count("joint"),
        leaves=skeleton.kinds.count("leaf"),
        bones=sum(parent >= 0 for parent in skeleton.parents),
        frames=len(skeleton.frames),
        seconds=seconds,
        **scores,
    )


def comparison(
    runs: tuple[ComparedRun, ComparedRun],
    skeletons: tuple[Skeleton, Skeleton],
    evaluations: tuple[Evaluation, Evaluation] | None,
    parameters: Sequence[ParameterDifference],
    limit: float,
) -> Comparison:
    """Pairs the joints of two skeletons and sets what they are against the truth side by side.

    evaluations : of both skeletons against the same truth; None where there is none
    limit       : largest mean distance of a pair, share of the height
    raises      : InputError where the frames or the units differ
    """
    check_frames_and_unit(runs[0].name, skeletons[0], runs[1].name, skeletons[1])
    (a, b), joints = skeletons, _true_joints(evaluations)
    height = evaluations[0].height if evaluations else float(np.mean([longest_side(s.vertices) for s in skeletons]))
    distance = allowed_distances(a.positions, b.positions, np.array(a.kinds)[:, None] == np.array(b.kinds))
    pairs = mutual_nearest(distance, limit * height)
    series, percent = pair_distances(a.positions, b.positions, pairs), 100.0 / height
    means = [distance[i, j] * percent for i, j in pairs if a.kinds[i] == "joint"]
    errors = [_errors(e, [row[side] for row in joints]) for side, e in enumerate(evaluations or ())]
    common = _common_percent(joints, errors, height, evaluations)
    none = np.zeros((len(a.frames), 0))
    return Comparison(
        a=runs[0].model_copy(update={"common_percent": common[0]}),
        b=runs[1].model_copy(update={"common_percent": common[1]}),
        frames=a.frames,
        unit=a.unit or b.unit,
        height=height,
        limit=limit,
        truth=evaluations[0].truth if evaluations else "",
        parameters=tuple(parameters),
        pairs=tuple(_pair(a, b, i, j, series[:, k], height) for k, (i, j) in enumerate(pairs)),
        only_a=_unpaired(a, b, {i for i, _ in pairs}, distance * percent),
        only_b=_unpaired(b, a, {j for _, j in pairs}, distance.T * percent),
        mean_percent=float(np.mean(means)) if means else None,
        true_joints=tuple(_true_joint(evaluations, row) for row in joints) if evaluations else (),
        distance=series,
        error_a=errors[0] if errors else none,
        error_b=errors[1] if errors else none,
    )


def check_frames_and_unit(name: str, a: Skeleton, other: str, b: Skeleton) -> None:
    """Raises InputError where two runs are of other frames or in another unit."""
    if a.frames != b.frames:
        apart = sorted(set(a.frames) ^ set(b.frames))
        raise InputError(
            f"{name} has {_range(a.frames)} and {other} has {_range(b.frames)}; {len(apart)} frames are in one of them alone,"
            f" the first is {apart[0]}. Runs are compared on the same frames: compute one of them again with --frames, or"
            " compare runs of the same sequence"
        )
    if a.unit and b.unit and a.unit != b.unit:
        raise InputError(
            f"{name} is in {a.unit} and {other} in {b.unit}; runs are compared in one unit: set sequence.unit to the same in"
            " both and compute them again"
        )


def check_sequence(name: str, a: Frames, other: str, b: Frames) -> None:
    """Raises InputError where two runs did not read the same body: other vertices, or a body at another place.

    a, b : of the same frames
    """
    for frame, source in a[0].items():
        if source.content == b[0][frame].content:
            continue
        one, two = a[1][frame], b[1][frame]
        counts = len(one.vertex_of_input), len(two.vertex_of_input)
        if counts[0] != counts[1] and source.kind in MESH_KINDS and b[0][frame].kind in MESH_KINDS:
            raise InputError(
                f"frame {frame} has {counts[0]} vertices in {name} and {counts[1]} in {other}; they are not runs of the same"
                " sequence, so their joints cannot be compared"
            )
        apart = box_difference(one.vertices, two.vertices)
        if apart > BOX_TOLERANCE:
            raise InputError(
                f"frame {frame}: the bodies of {name} and {other} lie {100 * apart:.0f} % of their size apart; they are runs of"
                " different sequences, or in different units or axes"
            )


def _range(frames: Sequence[int]) -> str:
    return f"{len(frames)} frames, {frames[0]} to {frames[-1]}"


def _pair(a: Skeleton, b: Skeleton, i: int, j: int, series: Floats, height: float) -> JointPair:
    """The row of one pair; `series` is its distance in every frame."""
    mean = float(series.mean())
    return JointPair(
        a=a.names[i], b=b.names[j], kind=a.kinds[i], mean=mean, worst=float(series.max()), percent=100.0 * mean / height
    )


def _unpaired(s: Skeleton, other: Skeleton, paired: set[int], percent: Floats) -> tuple[UnpairedJoint, ...]:
    """The joints of a skeleton that are in no pair, with the nearest of the other's; percent: (joint, joint of the other)."""
    rows = []
    order = sorted(set(range(len(s.names))) - paired, key=lambda i: (KINDS.index(s.kinds[i]), i))
    for i in order:
        near = int(percent[i].argmin()) if percent.shape[1] and np.isfinite(percent[i]).any() else None
        known = {} if near is None else {"nearest": other.names[near], "percent": float(percent[i, near])}
        rows.append(UnpairedJoint.model_validate({"name": s.names[i], "kind": s.kinds[i], **known}))
    return tuple(rows)


def _true_joints(evaluations: tuple[Evaluation, Evaluation] | None) -> list[tuple[int, int]]:
    """The places in both evaluations of every true joint that should be found, is a tip, or was found by one of them.

    A true joint that carries several rigid groups stands in an evaluation several times, not always equally often.
    """
    if evaluations is None:
        return []
    one, two = (_places(evaluation) for evaluation in evaluations)
    both = [(one[key], two[key]) for key in one if key in two]
    joints = evaluations[0].joints, evaluations[1].joints
    matched = [(i, j) for i, j in both if joints[0][i].found or joints[1][j].found]
    return [row for row in both if joints[0][row[0]].scored or joints[0][row[0]].kind == "tip" or row in matched]


def _places(evaluation: Evaluation) -> dict[tuple[str, int], int]:
    """The place of every true joint by its name and how often the name came before."""
    before: Counter[str] = Counter()
    places = {}
    for place, joint in enumerate(evaluation.joints):
        places[joint.name, before[joint.name]] = place
        before[joint.name] += 1
    return places


def _errors(evaluation: Evaluation, places: list[int]) -> Floats:
    """(frame, true joint) errors of some of the true joints."""
    return np.asarray(evaluation.error[:, places].reshape(len(evaluation.frames), -1), dtype=np.float64)


def _true_joint(evaluations: tuple[Evaluation, Evaluation], places: tuple[int, int]) -> TrueJoint:
    """The row of one true joint."""
    one, two = (_score(evaluation, place) for evaluation, place in zip(evaluations, places, strict=True))
    return TrueJoint(
        name=one.name, kind=one.kind, scored=one.scored, turns=one.turns,
        a=one.found, b=two.found, percent_a=one.percent, percent_b=two.percent,
    )  # fmt: skip


def _score(evaluation: Evaluation, place: int) -> JointScore:
    return evaluation.joints[place]


def _common_percent(
    joints: list[tuple[int, int]], errors: list[Floats], height: float, evaluations: tuple[Evaluation, Evaluation] | None
) -> tuple[float | None, float | None]:
    """Mean error in both runs of the scored joints that both found, % of the height."""
    if evaluations is None:
        return None, None
    scored = np.array([evaluations[0].joints[place].scored for place, _ in joints], dtype=bool)
    common = scored & np.isfinite(errors[0]).all(axis=0) & np.isfinite(errors[1]).all(axis=0)
    if not common.any():
        return None, None
    one, two = (100.0 * float(error[:, common].mean()) / height for error in errors)
    return one, two
