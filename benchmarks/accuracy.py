"""Every sequence whose truth is known, each preset, in one table: joints, ends of bones, duplicates and false joints apart.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/accuracy.py [--data FOLDER] [--only NAME ...] [--presets default paper-2014] [--seeds 0-9]
                                  [--kinds human adult clothed quadruped random fork] [--motions NAME ...] [--fps 12 30]
                                  [--frames 36] [--vertices 6000] [--work FOLDER] [--json FILE] [--markdown]
                                  [--fixed] [--set TASK.NAME=VALUE ...]

FOLDER holds NAME.npz beside NAME.truth.json, and NAME-body.npz with skinning weights where the true parts are known; a
NAME-body.npz with a truth of its own is a sequence too. Generated ones are of four kinds, one body a seed: adults are the
people adult:SEED with motions as recordings have them; humans and quadrupeds are the figures that ship, seed 0 as they are and
the others with other proportions, thicknesses and amplitudes; random trees differ in everything. On demand there are clothed
ones, the same people in loose clothes, and forks, several of whose limbs hang on one joint. Motions take turns with the seeds;
--motions says which of the adults'. --seeds is a range (0-9), a list (0,4,7) or none. --fps samples each adult's motion at
these rates, over the time that --frames frames cover at the first. --fixed gives each one connectivity. --work keeps the
stores, so that a second call computes only what changed. --set changes every run: geodesics.sum=bases spares the preset
paper-2014 Eq. 1 over all vertices, half a minute a frame, for what differs by 0.2 % from it.

A run that fails is not left out: it counts as a body with one joint in its middle. The lines after the bodies average groups.
Columns: found of scored joints within 5 % and, of these, within 2.5 % of the height; mean error of those found in % of the
height; spurious joints; CD-J2J, J2B and B2B in hundredths of the unit cube, joint IoU, precision and recall in %, all
against the joints that move (RigNet 2020); tree edit distance; adjusted Rand index and mean IoU of the parts; R_detection,
and E_dist in % of the height (2009); jitter of the error as a share of the true second differences; seconds a frame of what
this call computed.

A second table has the spread: per group mean ± standard deviation over the bodies of the share of joints found, their error,
the share of ends of bones found, their error, and a body's number of second joints beside a branching joint that is found
(several bones hang on it), of second joints beside another one, and of false ones, which have no true joint near them. A third
table counts the lost joints by name, both sides together.
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
from forked import forked

from kinetree.errors import KinetreeError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.input.sequence import Sequence as InputSequence
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.evaluation import Evaluation, EvaluationParams, Summary
from kinetree.schemas.results.truth import Truth, TruthParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.evaluation import evaluation
from kinetree.tasks.results.frame_truth import frame_truth
from kinetree.tasks.results.known_truth import known_truth
from kinetree.tasks.results.truth import synthetic, truth

PEOPLE = ("walk", "dance", "look", "reach", "run", "squat", "greet", "throw")
"""Motions of the figures adult:SEED, which take turns."""
KINDS = ("human", "adult", "quadruped", "random", "clothed", "fork")
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
        truth = {"file": str(path.absolute()), "body": str(body.absolute()) if body.exists() else ""}
        if (folder / f"{name}.npz").exists():
            yield Case(name, name, {"source": {"input": str((folder / f"{name}.npz").absolute())}, "truth": truth})


@dataclass(frozen=True)
class Bodies:
    """Which bodies are generated."""

    kinds: Sequence[str] = KINDS[:4]
    seeds: Sequence[int] = ()
    motions: Sequence[str] = PEOPLE
    rates: Sequence[float] = ()
    frames: int = 36
    vertices: int = 6000
    connectivity: str = "new"


def generated(bodies: Bodies, work: Path) -> Iterator[Case]:
    """One body of every kind for every seed, adults at every rate."""
    every = {"vertices": bodies.vertices, "connectivity": bodies.connectivity}
    for seed in bodies.seeds:
        for kind in bodies.kinds:
            options = {"seed": seed, "frames": bodies.frames, **every}
            if kind in ("adult", "clothed"):
                yield from _adults(kind, seed, bodies, options)
            elif kind == "random":
                yield Case(f"random-{seed}", kind, {"source": {"synth": {"figure": f"random:{seed}", **options}}})
            else:
                path = work / f"{kind}-{seed}.yaml"
                path.parent.mkdir(parents=True, exist_ok=True)
                motions = MOTIONS.get(kind, ("move",))
                path.write_text(yaml.safe_dump(forked(seed) if kind == "fork" else varied(kind, seed)))
                synth = {"file": str(path), "motion": motions[seed % len(motions)], **options}
                yield Case(f"{kind}-{seed}", kind, {"source": {"synth": synth}})


def _adults(kind: str, seed: int, bodies: Bodies, options: Mapping[str, Any]) -> Iterator[Case]:
    """One person at every rate, over the same time."""
    motion = bodies.motions[seed % len(bodies.motions)]
    synth = {**options, "figure": f"adult:{seed}", "motion": motion, "clothes": kind == "clothed"}
    if not bodies.rates:
        yield Case(f"{kind}-{seed}-{motion}", kind, {"source": {"synth": synth}})
    for rate in bodies.rates:
        frames = 1 + round((bodies.frames - 1) * rate / bodies.rates[0])
        block = {"source": {"synth": {**synth, "fps": rate, "frames": frames}}}
        yield Case(f"{kind}-{seed}-{motion}-{rate:g}", f"{kind} at {rate:g}", block)


def varied(figure: str, seed: int) -> dict[str, Any]:
    """A figure that ships, with other proportions, thicknesses and amplitudes; seed 0 as it is."""
    description: dict[str, Any] = yaml.safe_load((files("kinetree.configs") / "figures" / f"{figure}.yaml").read_text("utf-8"))
    if seed == 0:
        return description
    rng = np.random.default_rng(seed)
    scale, thick, wide = rng.uniform(0.88, 1.12, 3), rng.uniform(0.9, 1.1), rng.uniform(0.8, 1.15)
    for joint in description["joints"]:
        joint["position"] = [float(x * s) for x, s in zip(joint["position"], scale, strict=True)]
        for key in {"radius", "radii"} & set(joint):
            joint[key] = (np.array(joint[key]) * thick).tolist()
    for motion in description["motions"].values():
        for curves in motion.values():
            for curve in curves:
                if "amplitude" in curve:
                    curve["amplitude"] = float(curve["amplitude"] * wide)
    return description


def scored(
    case: Case, preset: str, work: Path, methods: Mapping[str, Graph] | None = None, sets: Sequence[str] = ()
) -> tuple[Evaluation, float, str]:
    """What one run is worth, the seconds a frame that it took, and why it failed, if it did."""
    blocks = {**case.blocks, "output": str(work / f"{case.name}-{preset}"), "store": str(work / "store")}
    begun, why = time.perf_counter(), ""
    pipeline = Pipeline.of({**blocks, **({} if preset == "default" else {"extends": preset})}, sets=sets, methods=methods)
    try:
        run = pipeline.run(until=["evaluation"])
        failures = [f"{f['node']}: {f['message']}" for f in run["failures"]]
        seconds = time.perf_counter() - begun
        if run["status"] == "done":
            evaluation: Any = pipeline.artifact("evaluation")
            return evaluation, seconds / max(len(evaluation.frames), 1), ""
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
    known = known_truth(true, source, InputSequence(frames=true.frames, fps=true.fps, unit=true.unit))
    none: dict[int, Any] = {}
    of_frames = {t: frame_truth(lone, known, {t: source[t]}, none, none, (t,)) for t in known.compared}
    return evaluation(lone, known, of_frames, EvaluationParams())


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


def spread(rows: Sequence[Mapping[str, Any]], markdown: bool = False) -> Iterator[str]:
    """Lines of the second table: every group of bodies with mean ± standard deviation over them."""
    heads = ("bodies", "joints found", "% err", "ends found", "% err ends", "2nd at branch", "2nd elsewhere", "false")
    yield _row(["group", *heads], markdown)
    if markdown:
        yield "|" + "---|" * (len(heads) + 1)
    for group in dict.fromkeys((row["group"], row["preset"]) for row in rows):
        mine = [row["summary"] for row in rows if (row["group"], row["preset"]) == group]
        figures: tuple[tuple[list[float], str], ...] = (
            ([100.0 * s["found"] / s["scored"] for s in mine if s["scored"]], ".1f"),
            ([s["percent"] for s in mine if s["percent"] is not None], ".2f"),
            ([100.0 * s["tips_found"] / s["tips"] for s in mine if s["tips"]], ".1f"),
            ([s["tip_percent"] for s in mine if s["tip_percent"] is not None], ".2f"),
            *(([float(s[key]) for s in mine], ".2f") for key in ("branch_duplicates", "duplicates", "false")),
        )
        cells_ = [_mean_and_deviation(values, form) for values, form in figures]
        yield _row([" ".join(group) if group[1] != "default" else group[0], str(len(mine)), *cells_], markdown)


def _mean_and_deviation(values: Sequence[float], form: str) -> str:
    """Mean ± standard deviation of a sample; the mean alone of one."""
    if not values:
        return "–"
    deviation = f" ± {np.std(values, ddof=1):{form}}" if len(values) > 1 else ""
    return f"{np.mean(values):{form}}{deviation}"


def lost_joints(rows: Sequence[Mapping[str, Any]], markdown: bool = False) -> Iterator[str]:
    """Lines of the third table: how often each joint is lost, of how often it turns; most often first."""
    yield _row(["group", "lost joints: lost of scored"], markdown)
    if markdown:
        yield "|---|---|"
    for group in dict.fromkeys((row["group"], row["preset"]) for row in rows):
        counts: dict[str, list[int]] = {}
        for row in rows:
            if (row["group"], row["preset"]) == group:
                for name, hits in row["joints"].items():
                    count = counts.setdefault(name.removesuffix("_l").removesuffix("_r"), [0, 0])
                    count[0] += hits.count(False)
                    count[1] += len(hits)
        losses = [f"{name} {k} of {n}" for name, (k, n) in sorted(counts.items(), key=lambda c: -c[1][0] / c[1][1]) if k]
        yield _row([" ".join(group) if group[1] != "default" else group[0], ", ".join(losses) or "none"], markdown)


def _row(cells_: Sequence[str], markdown: bool) -> str:
    """Cells side by side."""
    if markdown:
        return "| " + " | ".join(cells_) + " |"
    return "  ".join(f"{cell:16s}" for cell in cells_)


def seeds_of(text: str) -> list[int]:
    """0-9, 0,4,7 or none."""
    if text == "none":
        return []
    first, dash, last = text.partition("-")
    return list(range(int(first), int(last) + 1)) if dash else [int(part) for part in text.split(",")]


def line(name: str, preset: str, columns: Mapping[str, float | None], counts: str = "", markdown: bool = False) -> str:
    """A row of text; joints found as counts where there are some."""
    row = [f"{name:16s}", f"{preset:10s}"]
    for head in HEADS:
        value = columns[head]
        text = "–" if value is None else f"{value:.3f}" if head in ("ARI", "mIoU", "R_det") else f"{value:.2f}"
        if counts and head in ("found", "close"):
            text = counts.split()[head == "close"]
        row.append(f"{text:>7s}")
    return ("| " + " | ".join(row) + " |") if markdown else " ".join(row)


def averaged(rows: list[dict[str, float | None]]) -> dict[str, float | None]:
    """Each column averaged over the rows that have something in it."""
    columns = {head: [row[head] for row in rows if row[head] is not None] for head in HEADS}
    return {head: float(np.mean(values)) if values else None for head, values in columns.items()}


def _joint_outcomes(evaluation: Evaluation) -> dict[str, Any]:
    """What a body's row says of single joints."""
    hits: dict[str, list[bool]] = {}
    for joint in evaluation.joints:
        if joint.scored:
            hits.setdefault(joint.name, []).append(joint.found is not None)
    return {"joints": hits, "spurious": list(evaluation.spurious), "duplicate_of": list(evaluation.duplicate_of)}


def table(
    cases: list[Case], presets: list[str], work: Path, markdown: bool, sets: Sequence[str] = (), file: Path | None = None
) -> list[dict[str, Any]]:
    """Prints the table line by line as it comes, then the averages of each group; returns all rows, also in `file`."""
    blank: dict[str, float | None] = dict.fromkeys(HEADS)
    title = line("sequence", "preset", blank, markdown=markdown)
    for head in HEADS:
        title = title.replace(f"{'–':>7s}", f"{head:>7s}", 1)
    print(title + (("\n|" + "---|" * (len(HEADS) + 2)) if markdown else ""), flush=True)
    rows: list[dict[str, Any]] = []
    for case in cases:
        for preset in presets:
            evaluation, seconds, why = scored(case, preset, work, sets=sets)
            s = evaluation.summary or Summary()
            row = cells(s, seconds)
            counts = f"{s.found}/{s.scored} {s.close}/{s.scored}"
            print(line(case.name, preset, row, counts, markdown), *([f"FAILED {why}"] if why else []), flush=True)
            of_case = {"name": case.name, "group": case.group, "preset": preset, "failed": why, "cells": row}
            rows.append({**of_case, **_joint_outcomes(evaluation), "summary": s.model_dump(mode="json")})
            if file is not None:
                file.write_text(json.dumps(rows, indent=1, ensure_ascii=False))
    for group in dict.fromkeys(case.group for case in cases):
        for preset in presets:
            mine = [row for row in rows if row["group"] == group and row["preset"] == preset]
            if len(mine) > 1:
                failed = sum(bool(row["failed"]) for row in mine)
                name = f"{group} ×{len(mine)}" + (f", {failed} failed" if failed else "")
                print(line(name, preset, averaged([row["cells"] for row in mine]), markdown=markdown))
    for lines in (spread(rows, markdown), lost_joints(rows, markdown)):
        print("", *lines, sep="\n", flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--presets", nargs="*", default=["default", "paper-2014"])
    parser.add_argument("--seeds", type=seeds_of, default=[0, 1, 2], help="0-9, or 0,4,7, or none")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS[:4]))
    parser.add_argument("--motions", nargs="+", choices=PEOPLE, default=list(PEOPLE), help="of adults, in turn")
    parser.add_argument("--fps", nargs="*", type=float, default=[], help="of adults")
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
        bodies = Bodies(args.kinds, args.seeds, args.motions, args.fps, args.frames, args.vertices, kind)
        cases += generated(bodies, work / "figures")
        wanted = [case for case in cases if not args.only or any(case.name.startswith(name) for name in args.only)]
        table(wanted, args.presets, work, args.markdown, args.sets, args.json)


if __name__ == "__main__":
    main()
