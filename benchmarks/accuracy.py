"""Every sequence whose truth is known, each preset, in one table: joints found, errors, spurious ones, rigging measures, parts.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/accuracy.py [--data FOLDER] [--only NAME ...] [--presets default paper-2014] [--seeds 10]
                                  [--frames 36] [--vertices 6000] [--work FOLDER] [--json FILE] [--markdown]
                                  [--fixed] [--set TASK.NAME=VALUE ...]

FOLDER holds NAME.npz beside NAME.truth.json, and NAME-body.npz with skinning weights where the true parts are known; a
NAME-body.npz with a truth of its own is a sequence too. Generated ones are humans, adults, quadrupeds and random trees, so many
seeds of each: seed 0 is the figure as it ships, the others have other proportions, thicknesses and amplitudes; motions take
turns. --seeds 0 leaves them out; --fixed gives each one connectivity. --work keeps the stores, so that
a second call computes only what changed. --set changes every run: geodesics.sum=bases spares the preset paper-2014 Eq. 1 over
all vertices, half a minute a frame, for what differs by 0.2 % from it.

A run that fails is not left out: it counts as a body with one joint in its middle. The last lines average each group.
Columns: found of scored joints within 5 % and, of these, within 2.5 % of the height; mean error of those found in % of the
height; spurious joints; CD-J2J, J2B and B2B in hundredths of the unit cube, joint IoU, precision and recall in %, all
against the joints that move (RigNet 2020); tree edit distance; adjusted Rand index and mean IoU of the parts; R_detection,
and E_dist in % of the height (2009); jitter of the error as a share of the true second differences; seconds a frame of what
this call computed.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from kinetree.errors import KinetreeError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.evaluation import Evaluation, EvaluationParams, Summary
from kinetree.schemas.results.truth import Truth, TruthParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.evaluation import evaluation
from kinetree.tasks.results.truth import synthetic, truth

MOTIONS = {"human": ("walk", "wave", "squat"), "quadruped": ("walk", "look"), "adult": ("run", "greet")}
HEADS = (
    "found", "close", "% err", "spur", "J2J", "J2B", "B2B", "IoU", "P", "R", "edit", "ARI", "mIoU", "R_det", "E_dist", "jit",
    "s/frm",
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One sequence: its name, its group, and the blocks of configuration that name it and its truth."""

    name: str
    group: str
    blocks: Mapping[str, Any] = field(hash=False)


def recorded(folder: Path) -> Iterator[Case]:
    """Sequences of a folder, by name."""
    for path in sorted(folder.glob("*.truth.json")):
        name = path.name.removesuffix(".truth.json")
        body = folder / f"{name.removesuffix('-body')}-body.npz"
        told = {"file": str(path.absolute()), "body": str(body.absolute()) if body.exists() else ""}
        if (folder / f"{name}.npz").exists():
            yield Case(name, name, {"source": {"input": str((folder / f"{name}.npz").absolute())}, "truth": told})


def generated(seeds: int, frames: int, vertices: int, connectivity: str, work: Path) -> Iterator[Case]:
    """Humans, adults, quadrupeds and random trees."""
    every = {"frames": frames, "vertices": vertices, "connectivity": connectivity}
    for seed in range(seeds):
        for figure, motions in MOTIONS.items():
            path = work / f"{figure}-{seed}.yaml"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(yaml.safe_dump(varied(figure, seed)))
            synth = {"file": str(path), "motion": motions[seed % len(motions)], "seed": seed, **every}
            yield Case(f"{figure}-{seed}", figure, {"source": {"synth": synth}})
        yield Case(f"random-{seed}", "random", {"source": {"synth": {"figure": f"random:{seed}", "seed": seed, **every}}})


def varied(figure: str, seed: int) -> dict[str, Any]:
    """A figure that ships, with other proportions, thicknesses and amplitudes; seed 0 as it is."""
    told: dict[str, Any] = yaml.safe_load((files("kinetree.configs") / "figures" / f"{figure}.yaml").read_text("utf-8"))
    if seed == 0:
        return told
    rng = np.random.default_rng(seed)
    scale, thick, wide = rng.uniform(0.88, 1.12, 3), rng.uniform(0.9, 1.1), rng.uniform(0.8, 1.15)
    for joint in told["joints"]:
        joint["position"] = [float(x * s) for x, s in zip(joint["position"], scale, strict=True)]
        for key in {"radius", "radii"} & set(joint):
            joint[key] = (np.array(joint[key]) * thick).tolist()
    for motion in told["motions"].values():
        for curves in motion.values():
            for curve in curves:
                if "amplitude" in curve:
                    curve["amplitude"] = float(curve["amplitude"] * wide)
    return told


def scored(
    case: Case, preset: str, work: Path, methods: Mapping[str, Graph] | None = None, sets: Sequence[str] = ()
) -> tuple[Evaluation, float, str]:
    """What one run is worth, the seconds a frame that it took, and why it failed, if it did."""
    told = {**case.blocks, "output": str(work / f"{case.name}-{preset}"), "store": str(work / "store")}
    begun, why = time.perf_counter(), ""
    pipeline = Pipeline.of({**told, **({} if preset == "default" else {"extends": preset})}, sets=sets, methods=methods)
    try:
        run = pipeline.run(until=["evaluation"])
        failures = [f"{f['node']}: {f['message']}" for f in run["failures"]]
        seconds = time.perf_counter() - begun
        if run["status"] == "done":
            found: Any = pipeline.artifact("evaluation")
            return found, seconds / max(len(found.frames), 1), ""
        why = failures[0] if failures else run["status"]
    except KinetreeError as error:
        why, seconds = str(error), time.perf_counter() - begun
    true = _truth(case, pipeline)
    return nothing(true), seconds / len(true.frames), why


def nothing(true: Truth) -> Evaluation:
    """What it is worth to find nothing: one joint in the middle of the true ones."""
    T, X = len(true.frames), true.positions.mean(axis=1, keepdims=True)
    J, V = (T, 1), true.positions[0]
    lone = Skeleton(
        frames=true.frames, fps=true.fps, unit=true.unit, names=("root",), parents=(-1,), kinds=("root",),
        positions=X, rotation=np.tile(np.eye(3), (*J, 1, 1)), confidence=np.zeros(J), rest=X[0], degrees=np.zeros(1),
        drift=np.zeros(1), support=np.zeros(1, np.int32), vertices=V, faces=np.zeros((0, 3), np.int32),
        label=np.zeros(len(V), np.int32), influence=np.zeros((len(V), 4), np.int32), weight=np.tile(np.eye(4)[0], (len(V), 1)),
    )  # fmt: skip
    source = {frame: Source(content="", path="") for frame in true.frames}
    return evaluation(skeleton=lone, truth=true, source=source, mesh={}, projection={}, params=EvaluationParams())


def _truth(case: Case, pipeline: Pipeline) -> Truth:
    if "truth" in case.blocks:
        return truth(params=TruthParams.model_validate(case.blocks["truth"]), files=None)
    source: Any = pipeline.artifact("source", frame=0)
    return synthetic(source.recipe)


def cells(s: Summary, seconds: float) -> dict[str, float | None]:
    """One line of the table by its heads; None where there is nothing to say."""
    c, o = s.chamfer_moving, s.overlap_moving
    values = (
        100.0 * s.found / max(s.scored, 1), 100.0 * s.close / max(s.scored, 1), s.percent, s.spurious, c.j2j, c.j2b, c.b2b,
        o.iou, o.precision, o.recall, s.tree_edit, s.parts.adjusted_rand if s.parts else None,
        s.parts.mean_iou if s.parts else None, s.detection, 100.0 * s.distance, s.jitter, seconds,
    )  # fmt: skip
    return dict(zip(HEADS, values, strict=True))


def line(name: str, preset: str, told: Mapping[str, float | None], counts: str = "", markdown: bool = False) -> str:
    """A row of text; joints found as counts where there are some."""
    row = [f"{name:16s}", f"{preset:10s}"]
    for head in HEADS:
        value = told[head]
        text = "–" if value is None else f"{value:.3f}" if head in ("ARI", "mIoU", "R_det") else f"{value:.2f}"
        if counts and head in ("found", "close"):
            text = counts.split()[head == "close"]
        row.append(f"{text:>7s}")
    return ("| " + " | ".join(row) + " |") if markdown else " ".join(row)


def averaged(rows: list[dict[str, float | None]]) -> dict[str, float | None]:
    """Each column averaged over the rows that have something in it."""
    told = {head: [row[head] for row in rows if row[head] is not None] for head in HEADS}
    return {head: float(np.mean(values)) if values else None for head, values in told.items()}


def table(cases: list[Case], presets: list[str], work: Path, markdown: bool, sets: Sequence[str] = ()) -> list[dict[str, Any]]:
    """Prints the table line by line as it comes, then the averages of each group; returns all rows."""
    blank: dict[str, float | None] = dict.fromkeys(HEADS)
    title = line("sequence", "preset", blank, markdown=markdown)
    for head in HEADS:
        title = title.replace(f"{'–':>7s}", f"{head:>7s}", 1)
    print(title + (("\n|" + "---|" * (len(HEADS) + 2)) if markdown else ""), flush=True)
    rows: list[dict[str, Any]] = []
    for case in cases:
        for preset in presets:
            told, seconds, why = scored(case, preset, work, sets=sets)
            s = told.summary or Summary()
            row = cells(s, seconds)
            counts = f"{s.found}/{s.scored} {s.close}/{s.scored}"
            print(line(case.name, preset, row, counts, markdown), *([f"FAILED {why}"] if why else []), flush=True)
            lost = [joint.name for joint in told.joints if joint.scored and joint.found is None]
            rows.append({"name": case.name, "group": case.group, "preset": preset, "failed": why, "missing": lost,
                         "spurious": list(told.spurious), "cells": row, "summary": s.model_dump(mode="json")})  # fmt: skip
    for group in dict.fromkeys(case.group for case in cases):
        for preset in presets:
            mine = [row for row in rows if row["group"] == group and row["preset"] == preset]
            if len(mine) > 1:
                failed = sum(bool(row["failed"]) for row in mine)
                name = f"{group} ×{len(mine)}" + (f", {failed} failed" if failed else "")
                print(line(name, preset, averaged([row["cells"] for row in mine]), markdown=markdown))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--presets", nargs="*", default=["default", "paper-2014"])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--frames", type=int, default=36)
    parser.add_argument("--vertices", type=int, default=6000)
    parser.add_argument("--fixed", action="store_true")
    parser.add_argument("--set", action="append", default=[], dest="sets", metavar="TASK.NAME=VALUE")
    parser.add_argument("--work", type=Path)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--markdown", action="store_true")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = (args.work or Path(scratch)).absolute()
        cases = [*recorded(args.data)] if args.data else []
        kind = "fixed" if args.fixed else "new"
        cases += generated(args.seeds, args.frames, args.vertices, kind, work / "figures")
        wanted = [case for case in cases if not args.only or any(case.name.startswith(name) for name in args.only)]
        rows = table(wanted, args.presets, work, args.markdown, args.sets)
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1, ensure_ascii=False))


if __name__ == "__main__":
    main()
