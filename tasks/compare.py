"""Compares two runs from Python: `compare("walk-out", "walk-paper")` gives what `kinetree compare` prints, typed."""

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, cast

from kinetree.errors import ConfigError, InputError, KinetreeError, NodesFailedError, UnknownNodeError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.schemas.array import Artifact, Params
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.coarse_mesh import CoarseMesh
from kinetree.schemas.results.comparison import Comparison, ParameterDifference
from kinetree.schemas.results.evaluation import Evaluation, EvaluationParams, JointScore
from kinetree.schemas.results.truth import TruthParams
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.scene import evenly_spread
from kinetree.tasks.results.comparison import check_frames_and_unit, check_sequence, compared_run, comparison
from kinetree.tasks.results.formats.names import readable_names
from kinetree.tasks.results.page.coarse import coarse_meshes
from kinetree.tasks.results.page.scene import Limits, Scene, scene
from kinetree.tasks.results.plots.drawing import view

SHOWN = Limits(frames=90, vertices=3000, input_vertices=1500)
"""Most of each body that a page of two holds."""
A = TypeVar("A", bound=Artifact)
P = TypeVar("P", bound=Params)
Tell = Callable[[str], None]
"""Takes a remark, in words."""


@dataclass(frozen=True)
class FinishedRun:
    """A run whose skeleton is there, as a comparison reads it."""

    name: str
    pipeline: Pipeline
    there: Snapshot
    skeleton: Skeleton
    """Its joints as people call them, where that is known."""
    label: Mapping[str, str]
    """What people call each joint, by the name in the store."""

    @staticmethod
    def of(run: str | Path) -> "FinishedRun":
        """The run that a configuration or an output folder names; raises UnknownNodeError where it is not finished."""
        pipeline = Pipeline.of(run)
        there = pipeline.inspect()
        try:
            skeleton = there.artifact(Skeleton)
        except UnknownNodeError:
            stale = next((node for node in there.plan.nodes if node.state == "stale"), "nothing of it is computed")
            raise UnknownNodeError(
                f"{run} is not finished, or was computed by another version or with other parameters: {stale};"
                f" kinetree run {run} computes what is missing"
            ) from None
        label = _labels(there)
        names = tuple(label.get(name, name) for name in skeleton.names)
        return FinishedRun(str(run), pipeline, there, skeleton.model_copy(update={"names": names}), label)

    def by_frame(self, cls: type[A]) -> dict[int, A]:
        """The artifacts of one class by source frame number."""
        return {frame: self.there.artifact(cls, frame=frame) for frame in self.skeleton.frames}

    def params(self, cls: type[P]) -> P:
        """The parameters of a class with which it ran."""
        return next(params for params in self.pipeline.config.params.values() if isinstance(params, cls))

    @cached_property
    def seconds(self) -> float:
        """That computing the skeleton and all it is made from took."""
        graph = self.pipeline.tasks
        needed = {task.name for task in graph.until([graph.writer(Skeleton).name]).tasks}
        return sum(row.seconds for row in self.there.timings.tasks if row.task in needed)

    def evaluation(self, sets: list[str], tell: Tell | None = None) -> Evaluation | None:
        """Its skeleton against the truth, computed where it is not there, as `evaluated`; None where there is no truth."""
        evaluation = evaluated(Pipeline.of(self.name, sets=sets), tell)
        return None if evaluation is None else labelled(evaluation, self.label)


def _labels(there: Snapshot) -> Mapping[str, str]:
    """What people call each joint, by the name in the store; empty where nothing is known, or two would be called the same."""
    try:
        known = there.artifact(JointNames)
    except KinetreeError:  # a graph without names, or a run that did not come so far
        return {}
    labels = readable_names(known)
    return dict(zip(known.given, labels, strict=True)) if len(set(labels)) == len(labels) else {}


def labelled(evaluation: Evaluation, label: Mapping[str, str]) -> Evaluation:
    """The same evaluation with other names for found joints.

    label : by the name in the evaluation; a joint that is not there keeps its name
    """

    def named(joint: JointScore) -> JointScore:
        return joint if joint.found is None else joint.model_copy(update={"found": label.get(joint.found, joint.found)})

    others = {
        "joints": tuple(named(joint) for joint in evaluation.joints),
        "spurious": tuple(label.get(name, name) for name in evaluation.spurious),
    }
    return evaluation.model_copy(update=others)


def compare(run_a: str | Path, run_b: str | Path, truth: str | Path | None = None) -> Comparison:
    """Compares two finished runs of the same sequence.

    run_a, run_b : configurations or output folders
    truth        : a truth.json, a skeleton.json or a BVH; None takes the truth of the first run, or else that of the second
    raises       : ConfigError where both are one run; UnknownNodeError where one is not finished; InputError where they are
                   not runs of the same sequence, or the truth is not that of its body
    """
    return compared(*both(run_a, run_b), truth)


def both(run_a: str | Path, run_b: str | Path) -> tuple[FinishedRun, FinishedRun]:
    """The two runs; raises as `compare`, but for the truth."""
    a, b = FinishedRun.of(run_a), FinishedRun.of(run_b)
    if a.pipeline.config.output.resolve() == b.pipeline.config.output.resolve():
        raise ConfigError(
            f"{run_a} and {run_b} are the same run, in {a.pipeline.config.output}; compute the other one into a folder of its"
            " own with --output"
        )
    check_frames_and_unit(a.name, a.skeleton, b.name, b.skeleton)
    check_sequence(a.name, (a.by_frame(Source), a.by_frame(Mesh)), b.name, (b.by_frame(Source), b.by_frame(Mesh)))
    return a, b


def compared(a: FinishedRun, b: FinishedRun, truth: str | Path | None = None, tell: Tell | None = None) -> Comparison:
    """The comparison of two runs that `both` gives; raises as `compare`, tells as `evaluated`."""
    sets = [*_truth(a, b, truth), *_settings(a)]
    evaluations = a.evaluation(sets, tell), b.evaluation(sets, tell)
    has_truth = all(evaluations)
    rows = [
        compared_run(run.name, run.pipeline.config.method, run.skeleton, e, run.seconds)
        for run, e in zip((a, b), evaluations, strict=True)
    ]
    return comparison(
        (rows[0], rows[1]),
        (a.skeleton, b.skeleton),
        cast("tuple[Evaluation, Evaluation]", evaluations) if has_truth else None,
        list(differences(a.pipeline, b.pipeline)),
        a.params(EvaluationParams).found,
    )


def scenes(a: FinishedRun, b: FinishedRun, limits: Limits = SHOWN) -> tuple[Scene, Scene]:
    """Both bodies as a page plays them, along the axes of the first; raises UnknownNodeError where a result is missing."""
    up = a.there.artifact(UpDirection).axis
    axes = view([mesh.vertices for mesh in a.by_frame(Mesh).values()], up)
    first, second = (
        scene(
            run.skeleton,
            run.by_frame(Alignment),
            _inputs(run, limits),
            run.there.artifact(Leaves),
            run.there.artifact(Intervals),
            limits,
            axes=axes,
        )
        for run in (a, b)
    )
    return first, second


def _inputs(run: FinishedRun, limits: Limits) -> dict[int, CoarseMesh]:
    """The input meshes of the frames that play, coarse."""
    frames = [run.skeleton.frames[t] for t in evenly_spread(len(run.skeleton.frames), limits.frames)]
    meshes, projections = run.by_frame(Mesh), run.by_frame(Projection)
    return coarse_meshes({f: meshes[f] for f in frames}, {f: projections[f] for f in frames}, limits.input_vertices)


def evaluated(pipeline: Pipeline, tell: Tell | None = None) -> Evaluation | None:
    """The evaluation of a pipeline's skeleton, computed where it is not there; None where there is no truth.

    tell   : is told in words where what is computed cannot be kept
    raises : InputError where the truth is wrong; UnknownNodeError where what it is made from is not there
    """
    try:
        there = pipeline.computed("evaluation", also=("known_truth", "frame_truth"))
    except NodesFailedError as error:
        if f": {InputError.__name__}: " in str(error):
            raise InputError(str(error).partition(f": {InputError.__name__}: ")[2]) from None
        raise
    if there.unkept and tell is not None:
        tell(there.unkept)
    stored = there.artifact(Evaluation)
    return None if stored.summary is None else Evaluation.model_validate({**stored.plain(), **stored.arrays()})


def differences(a: Pipeline, b: Pipeline) -> Iterator[ParameterDifference]:
    """The parameters that differ, without paths; of a task that only one method has, those that are not at their default."""
    if a.config.method != b.config.method:
        yield ParameterDifference(key="method", a=a.config.method, b=b.config.method)
    for task in dict.fromkeys([*a.config.params, *b.config.params]):
        one, two = a.config.params.get(task), b.config.params.get(task)
        in_both = one is not None and two is not None
        left, right = (_values(params, defaults=in_both) if params else {} for params in (one, two))
        for key in dict.fromkeys([*left, *right]):
            if left.get(key) != right.get(key):
                yield ParameterDifference(key=f"{task}.{key}", a=left.get(key), b=right.get(key))


def _values(params: Params, *, defaults: bool) -> dict[str, str]:
    """Every parameter as JSON by its key, without paths and with or without those at their default."""
    paths = {".".join(keys) for keys in params.path_fields()}
    flat = _flat(params.model_dump(mode="json", exclude_defaults=not defaults))
    return {key: json.dumps(value, ensure_ascii=False) for key, value in flat if key not in paths}


def _flat(values: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, dict) and value:
            yield from _flat(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def _truth(a: FinishedRun, b: FinishedRun, truth: str | Path | None) -> list[str]:
    """The same truth for both runs, as overrides: the one named, or else that of the first run that names one."""
    own = next((p for p in (run.params(TruthParams) for run in (a, b)) if p.file), a.params(TruthParams))
    chosen = own if truth is None else own.model_copy(update={"file": str(Path(truth).absolute()), "body": ""})
    return [f"truth.{key}={json.dumps(value)}" for key, value in chosen.model_dump().items()]


def _settings(a: FinishedRun) -> list[str]:
    """The limits of the first run, so that both are judged alike."""
    return [f"evaluation.{key}={json.dumps(value)}" for key, value in a.params(EvaluationParams).model_dump().items()]
