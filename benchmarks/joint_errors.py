"""The joints of one run after another: what is known of them, and how far off they are."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from accuracy import Case
from robustness import kept_rows

from kinetree.errors import KinetreeError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.error_bars import JointFeatures
from kinetree.tasks.results.truth import synthetic
from kinetree.tasks.structure.error_bars import joint_features


class Joints(NamedTuple):
    """The joints of one run: its body, what is known of them, (frame, joint) errors in the mesh unit, cuts and height."""

    body: str
    features: JointFeatures
    error: Floats
    cuts: int
    height: float

    @property
    def mean(self) -> Floats:
        """(joint,) mean error, mesh unit."""
        return np.asarray(self.error.mean(axis=0))


def joints_of(case: Case, work: Path, sets: Sequence[str]) -> Joints | None:
    """Runs a sequence as far as needed; None where nothing can be said."""
    blocks = {"output": str(work / f"{case.name}-default"), "store": str(work / "store"), **case.blocks}
    try:
        pipeline = Pipeline.of(blocks, sets=sets)
        pipeline.run(until=["evaluation"])
        return judged(body_of(case.name), pipeline.inspect(until=["evaluation"]))
    except KinetreeError as error:
        print(f"{case.name}: {error}", flush=True)
        return None


def body_of(name: str) -> str:
    """The body of a run: its figure and seed, or the recorded sequence without what was done to it."""
    return "-".join(name.removeprefix("fixed-").removeprefix("long-").split("-")[:2]).removesuffix("-body")


def spoilt(work: Path) -> Iterator[Case]:
    """The runs that a call of `benchmarks/robustness.py` left, but for those of two bodies."""
    for row in kept_rows(work).values():
        label = f"{row['clip']}-{row['kind']}-{row['level']:g}"
        if not row["refused"] and row["kind"] != "bodies":
            clip = work / "clips" / label
            blocks = {"source": {"input": str(clip)}, "truth": {"file": str(clip / "truth.json")}, "store": str(work / "store")}
            yield Case(label, f"spoilt {row['clip'].partition('-')[0]}", {**blocks, "output": str(work / "runs" / label)})


def judged(body: str, there: Snapshot) -> Joints:
    """The joints of a run of a body and their errors."""
    skeleton, tree, evaluation, truth = (there.artifact(n) for n in ("skeleton", "kinematic_tree", "evaluation", "truth"))
    if not truth.names:
        truth = synthetic(there.artifact("source", frame=skeleton.frames[0]).recipe)
    row = {frame: t for t, frame in enumerate(truth.frames)}
    at = [row[f] for f in skeleton.frames] if set(skeleton.frames) <= set(row) else list(range(len(skeleton.frames)))
    is_joint = np.array([kind == "joint" for kind in truth.kinds])
    Y = np.array(truth.positions)[at][:, is_joint]
    away = np.linalg.norm(np.array(skeleton.positions)[:, :, None] - Y[:, None], axis=3)
    nearest = away.mean(axis=0).argmin(axis=1)
    error = np.take_along_axis(away, nearest[None, :, None], axis=2)[:, :, 0]
    place = {name: j for j, name in enumerate(skeleton.names)}
    for k, joint in enumerate(evaluation.joints):
        if joint.found is not None and joint.kind == "joint":
            error[:, place[joint.found]] = evaluation.error[:, k]
    turning = np.array([kind == "joint" for kind in skeleton.kinds])
    f = joint_features(skeleton, tree)
    own = JointFeatures(*(np.asarray(a)[..., turning] for a in f[:-1]), f.size)
    return Joints(body, own, error[:, turning], tree.cuts, evaluation.height)
