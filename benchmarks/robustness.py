"""What noise, holes, losses, contacts and strangers in the picture do to the result, and whether the run says so.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/robustness.py [--figures human quadruped random] [--seeds 1] [--frames 16] [--vertices 2000]
                                    [--data FOLDER --sequences NAME ...] [--only KIND[=LEVEL] ...] [--preset default]
                                    [--work FOLDER] [--again | --lately] [--json FILE] [--markdown]

Every sequence is spoilt in one way at a time, by levels; none is the sequence as it is. FOLDER holds NAME.npz beside
NAME.truth.json. Generated bodies cover the same motion whatever their number of frames. Lengths are shares of the height:

    noise       root mean square along the normals, part white and part smooth
    holes       radius of three holes in every frame
    frames      share of the frames that are not there, at random, their numbers left free
    rate        share of the frame rate that is kept
    vertices    share of the vertices that is kept, by decimation
    limb        frames in the middle in which one limb is cut off and leaves an open end
    contact     frames in the middle in which a hand rests on the hip and grows together with it (generated humans only)
    bodies      a second body that stands beside the first one, in every frame
    object      radius of a ball that is carried at the end of a limb and crosses its surface
    clothes     root mean square of smooth waves along the normals that differ in every frame, as long as a third of the height

Columns: found of scored joints; mean error of those found, % of the height; spurious joints; runs that were refused; runs with
a joint of the result more than 5 % of the height off (where no true joint is, over all frames, or in some frame where its
partner is not) and in how many of these the verdict was not good; runs that miss a scored joint although none is off, and in
how many of these the verdict was not good; of all other runs, in how many it was not good all the same; runs of which the
verdict is that they are not to be used. A refusal counts as noticed. Found and error have ± the standard deviation over
bodies of the share of joints found and of the error. Every seed comes with one figure first, then with the next one, so that
a call that is stopped has tried many bodies; with --work a second call goes on there. --again judges what is there anew,
after the verdict was changed. --lately tells only what is there.
"""

import argparse
import json
import tempfile
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from spoilt import KINDS, Clip, generated, recorded

from kinetree.errors import KinetreeError
from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.results.evaluation import Summary

ROWS = "rows.jsonl"
OFF = 5.0
"""From how far on a joint is off, % of the height."""


# ── what became of it ───────────────────────────────────────────────────────────────────────────────────────────────


def measured(clip: Clip, work: Path, label: str, preset: str) -> dict[str, Any]:
    """What one run is worth, and what it remarked."""
    folder = work / "clips" / label
    folder.mkdir(parents=True, exist_ok=True)
    for t, (V, F) in clip.meshes.items():
        (folder / f"frame_{t:04d}.ply").write_bytes(trimesh.Trimesh(V, F, process=False).export(file_type="ply"))
    (folder / "truth.json").write_text(json.dumps(clip.truth))
    blocks = {
        "source": {"input": str(folder)}, "truth": {"file": str(folder / "truth.json")}, "store": str(work / "store"),
        "output": str(work / "runs" / label), **({} if preset == "default" else {"extends": preset}),
    }  # fmt: skip
    try:
        pipeline = Pipeline.of(blocks)
        run = pipeline.run(until=["evaluation", "verdict"])
        if run["status"] != "done":
            return {"refused": run["failures"][0]["message"]}
        evaluation: Any = pipeline.artifact("evaluation")
        judged: Any = pipeline.artifact("verdict")
    except KinetreeError as error:
        return {"refused": str(error)}
    s = evaluation.summary or Summary()
    percent = {
        str(joint.found): 100 * float(np.nanmax(evaluation.error[:, j])) / evaluation.height
        for j, joint in enumerate(evaluation.joints) if joint.scored and joint.found is not None
    }  # fmt: skip
    return {
        "refused": "", "found": s.found, "scored": s.scored, "percent": s.percent, "spurious": list(evaluation.spurious),
        "lost": [joint.name for joint in evaluation.joints if joint.scored and joint.found is None],
        "strayed": {name: worst for name, worst in percent.items() if worst > OFF},
        "verdict": judged.level, "findings": [finding.model_dump(mode="json") for finding in judged.findings],
    }  # fmt: skip


def off(row: dict[str, Any]) -> bool:
    """Whether a joint of the result is where no true joint is, or strays from its partner in some frame."""
    return bool(row["spurious"] or row["strayed"])


def noticed(row: dict[str, Any]) -> bool:
    """Whether the run says that something is not to be relied on."""
    return bool(row["refused"] or row["verdict"] != "good")


Level = tuple[str, float]


def levels(chosen: list[str]) -> list[Level]:
    """Kinds with their levels, of words such as `noise` and `noise=0.003`; the sequence as it is comes first."""
    named = [word.partition("=") for word in ("none", *chosen)]
    pairs = [(kind, level) for kind, _, one in named for level in ([float(one)] if one else KINDS[kind][1])]
    return list(dict.fromkeys(pairs))


def kept_rows(work: Path) -> dict[tuple[str, str, float], dict[str, Any]]:
    """What earlier calls measured, by clip, kind and level."""
    file = work / ROWS
    rows = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    return {(row["clip"], row["kind"], row["level"]): row for row in rows}


def measure(clips: Iterator[Clip], chosen: list[Level], work: Path, preset: str) -> Iterator[dict[str, Any]]:
    """One row a clip, kind and level; those of an earlier call are read."""
    there = kept_rows(work)
    for clip in clips:
        for kind, level in chosen:
            if kind == "contact" and not clip.name.startswith("human-"):
                continue
            row = there.get((clip.name, kind, level))
            if row is None:
                label = f"{clip.name}-{kind}-{level:g}"
                row = {"clip": clip.name, "kind": kind, "level": level,
                       **measured(KINDS[kind][0](clip, level), work, label, preset)}  # fmt: skip
                with (work / ROWS).open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row, ensure_ascii=False) + "\n")
            yield row


def generated_bodies(figures: list[str], seeds: int, frames: int, vertices: int) -> Iterator[Clip]:
    """Every seed with one figure, then every seed with the next one."""
    for turn in range(len(figures)):
        for seed in range(seeds):
            yield generated(figures[(seed + turn) % len(figures)], seed, frames, vertices)


def summed(rows: list[dict[str, Any]], markdown: bool = False) -> Iterator[str]:
    """A line for every kind and level, over all clips, and one over all of them."""
    head = (
        "kind",
        "level",
        "found",
        "share",
        "% err",
        "spur",
        "refused",
        "off",
        "noticed",
        "missed",
        "noticed",
        "right",
        "doubted",
        "unusable",
    )
    yield ("| " + " | ".join(head) + " |\n|" + "---|" * len(head)) if markdown else "  ".join(f"{h:>9s}" for h in head)
    for kind, level in [*dict.fromkeys((row["kind"], row["level"]) for row in rows), ("all", None)]:
        mine = [row for row in rows if level is None or (row["kind"], row["level"]) == (kind, level)]
        done = [row for row in mine if not row["refused"]]
        percents = [row["percent"] for row in done if row["percent"] is not None]
        wrong = [row for row in done if off(row)]
        missed = [row for row in done if row["lost"] and not off(row)]
        right = [row for row in done if not row["lost"] and not off(row)]
        shares = [row["found"] / row["scored"] for row in done if row["scored"]]
        cells = (
            kind, "" if level is None else f"{level:g}", f"{sum(r['found'] for r in done)}/{sum(r['scored'] for r in done)}",
            _spread(shares), _spread(percents), sum(len(r["spurious"]) for r in done),
            f"{len(mine) - len(done)}/{len(mine)}", *(f(runs) for runs in (wrong, missed, right) for f in (len, _noticed)),
            sum(row["verdict"] == "unusable" for row in done),
        )  # fmt: skip
        yield ("| " + " | ".join(map(str, cells)) + " |") if markdown else "  ".join(f"{c!s:>9s}" for c in cells)


def _spread(figures: list[float]) -> str:
    return f"{np.mean(figures):.2f} ± {np.std(figures):.2f}" if figures else "–"


def _noticed(rows: list[dict[str, Any]]) -> int:
    return sum(map(noticed, rows))


def _line(row: dict[str, Any]) -> str:
    if row["refused"]:
        return str(row["refused"])
    figures = f"{row['found']}/{row['scored']} {row['percent'] or 0:.2f} % {len(row['spurious'])} spurious"
    kinds = ", ".join(dict.fromkeys(finding["kind"] for finding in row["findings"] if finding["severity"] != "note"))
    return f"{figures}  {len(row['strayed'])} strayed  {row['verdict']} ({kinds})"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--figures", nargs="*", default=["human", "quadruped", "random"])
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--frames", type=int, default=16)
    parser.add_argument("--vertices", type=int, default=2000)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--sequences", nargs="*", default=[])
    parser.add_argument("--only", nargs="*", default=list(KINDS), metavar="KIND[=LEVEL]")
    parser.add_argument("--preset", default="default")
    parser.add_argument("--work", type=Path)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--lately", action="store_true")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--markdown", action="store_true")
    args = parser.parse_args()
    if unknown := {word.partition("=")[0] for word in args.only} - set(KINDS):
        parser.error(f"{', '.join(sorted(unknown))}: no such kind; there are {', '.join(KINDS)}")
    with tempfile.TemporaryDirectory() as scratch:
        work = (args.work or Path(scratch)).absolute()
        work.mkdir(parents=True, exist_ok=True)
        if args.again:
            (work / ROWS).unlink(missing_ok=True)
        clips = chain((recorded(args.data, name) for name in args.sequences),
                      generated_bodies(args.figures, args.seeds, args.frames, args.vertices))  # fmt: skip
        rows = []
        for row in kept_rows(work).values() if args.lately else measure(clips, levels(args.only), work, args.preset):
            rows.append(row)
            if not args.lately:
                print(row["clip"], row["kind"], f"{row['level']:g}", _line(row), sep="  ", flush=True)
        print(*summed(rows, args.markdown), sep="\n")
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1, ensure_ascii=False))


if __name__ == "__main__":
    main()
