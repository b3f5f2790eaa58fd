"""One mesh aligned to all frames, against the truth: vertex error, turning of every joint, seconds a frame, residual.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/alignment.py --data FOLDER [--only NAME ...] [--every N] [--reference FRAME] [--set TASK.NAME=VALUE ...]
                                   [--work FOLDER] [--peer] [--plot FOLDER]
    python benchmarks/alignment.py --generated [--only FIGURE ...] [--every N] [--set TASK.NAME=VALUE ...] [--work FOLDER]
                                   [--plot FOLDER]

What is scored is what `kinetree run` leaves: the graph runs up to `frame_confidence`. FOLDER holds sequences NAME.npz
(vertices, faces, vertex_offsets, face_offsets); where NAME-body.npz and NAME.truth.json lie beside them, errors are given in %
of the body's height; elsewhere residuals only, in % of the body's size. Seconds are those of the tasks of the shelf
`registration`, one after the other, as their records say. --every N takes each Nth frame alone, as a camera of that rate would
show a body that moves N times as fast. --work keeps the stores, so that a second call computes only what changed. --peer
aligns one frame with trimesh's nricp_amberg too and gives the ratio.

--generated scores bodies that kinetree makes itself, with contacts and noise: a figure and its motion, or random:SEED for
random trees. The seed of motion and noise is the figure's place in the list of all, whatever --only names. The truth is the
same body skinned in every frame; `limb` is the largest mean error of one limb in one frame: a limb that sits on another has
tens of percent.
"""

import argparse
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
from generated_truth import height, parts, skinned_motion
from turning import Truth

from kinetree.pipeline import Pipeline
from kinetree.tasks.numerics.registration.frame_confidence import residuals
from kinetree.tasks.registration import REGISTRATION

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

# figure:motion, or random:SEED, and per contact: limb, target, first and last frame
GENERATED: dict[str, tuple[tuple[str, str, int, int], ...]] = {
    "human:walk": (("hand_r", "hip_r", 6, 12),),
    "human:wave": (("hand_l", "hip_l", 12, 18),),
    "human:squat": (),
    "quadruped:": (),
    "bird:": (),
    **{f"random:{seed}": () for seed in range(5)},
}


@dataclass(frozen=True)
class Aligned:
    """What the graph made of one sequence.

    frames     : source number of every frame
    start      : the reference's place among them
    V, F, size : reference (vertex, xyz) mesh unit · (face, corner) · √area of it, mesh unit
    x          : (frame, vertex, xyz) mesh unit
    meshes     : by frame, V (source, xyz) mesh unit and F (face, corner), clean
    uncovered  : (frame,) share of each frame's surface that the body does not explain
    doubted    : how many frames stand out
    recipe     : of a generated sequence; else empty
    seconds    : of registration, a frame
    """

    frames: tuple[int, ...]
    start: int
    V: Floats
    F: Ints
    size: float
    x: Floats
    meshes: list[tuple[Floats, Ints]]
    uncovered: Floats
    doubted: int
    recipe: str
    seconds: float

    @property
    def residual(self) -> float:
        """Mean distance from the frames' surfaces, % of the size."""
        mean = [residuals(x, *mesh).mean() for x, mesh in zip(self.x, self.meshes, strict=True)]
        return float(np.mean(mean) / self.size * 100)

    def cells(self) -> str:
        """What every line of the tables has."""
        counts = f"{self.frames[self.start]:4d} {len(self.frames):4d} {self.seconds:6.2f}"
        return f"{counts} {self.residual:6.3f} {self.uncovered.max():6.3f} {self.doubted:3d}"


def aligned(source: Mapping[str, Any], work: Path, sets: Sequence[str] = ()) -> Aligned:
    """A sequence aligned by the graph.

    source : the block of the configuration
    work   : folder for its store and output
    sets   : overrides as task.name=value
    raises : SystemExit where a node fails
    """
    config = {"source": dict(source), "output": str(work / "output"), "store": str(work / "store")}
    pipeline = Pipeline.of({**config, "compute": {"executor": "threads", "workers": 1}}, sets=sets)
    run = pipeline.run(until=["frame_confidence"])
    if run["status"] != "done":
        raise SystemExit("; ".join(f"{f['node']}: {f['message']}" for f in run["failures"]) or str(run["status"]))
    there = pipeline.inspect(until=["frame_confidence"])
    reference, confidence = there.artifact("reference"), there.artifact("frame_confidence")
    frames = tuple(there.artifact("sequence").frames)
    poses, meshes = ([there.artifact(what, frame=t) for t in frames] for what in ("alignment", "mesh"))
    shelf = {task.name for task in REGISTRATION}
    return Aligned(
        frames=frames,
        start=frames.index(reference.frame),
        V=np.array(reference.vertices),
        F=np.array(reference.faces, np.int64),
        size=float(reference.size),
        x=np.stack([pose.vertices for pose in poses]),
        meshes=[(np.array(m.vertices), np.array(m.faces, np.int64)) for m in meshes],
        uncovered=np.array(confidence.uncovered),
        doubted=int((~np.array(confidence.inlier)).sum()),
        recipe=there.artifact("source", frame=frames[0]).recipe,
        seconds=sum(row.seconds for row in there.timings.tasks if row.task in shelf) / len(frames),
    )


def peer(mine: Aligned) -> None:
    """One frame by trimesh's nricp_amberg, in the same run."""
    mesh = mine.meshes[mine.start + 1 if mine.start + 1 < len(mine.meshes) else mine.start - 1]
    begun = time.process_time()
    source, target = (trimesh.Trimesh(*both, process=False) for both in ((mine.V, mine.F), mesh))
    fitted = trimesh.registration.nricp_amberg(source, target)
    spent = time.process_time() - begun
    error = residuals(np.asarray(fitted), *mesh).mean() / mine.size * 100
    print(f"    nricp_amberg: {spent:.1f} s for one frame, residual {error:.3f} %: {spent / mine.seconds:.0f} times as long")


def plotted(folder: Path, name: str, mine: Aligned) -> None:
    """Aligned (red) over input (grey) for six frames, three views."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    picked = np.linspace(0, len(mine.frames) - 1, 6).astype(int)
    figure, axes = plt.subplots(2, 6, figsize=(24, 11))
    for column, k in enumerate(picked):
        for row, (a, b) in enumerate(((0, 1), (2, 1))):
            ax = axes[row, column]
            ax.scatter(*mine.meshes[k][0][:, [a, b]].T, s=0.4, c="0.6")
            ax.triplot(*mine.x[k][:, [a, b]].T, mine.F[::4], lw=0.15, color="r")
            ax.set_aspect("equal")
            ax.set_title(f"{name} {mine.frames[k]}")
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / f"{name}.png", dpi=60)


def scored(folder: Path, name: str, args: argparse.Namespace, work: Path) -> None:
    """One line of the table, and the joints that turn too little."""
    source = {"input": str((folder / f"{name}.npz").absolute()), "frames": f"::{args.every}"}
    mine = aligned(source, work / f"{name}-{args.every}", args.sets)
    line, low = f"{name:9s} {mine.cells()}", []
    if (folder / f"{name}-body.npz").exists():
        every = Truth.of(folder, name, mine.V, mine.frames[mine.start])
        truth = Truth(every.x[list(mine.frames)], every.part, every.label, every.joints, every.height)
        error = np.linalg.norm(mine.x - truth.x, axis=2) / truth.height * 100
        turns = truth.turns(mine.x, mine.start)
        low = [f"{t.joint} {t.share:.2f}/{t.peak:.2f} of {t.degrees:.0f}°" for t in turns if min(t.share, t.peak) < 0.8]
        line += f" {error.mean():7.3f} {np.quantile(error, 0.95):6.2f} {error.max():6.1f}"
        line += f" {len(turns) - len(low):3d}/{len(turns)}"
    print(line, flush=True)
    if low:
        print("    turning below 0.8 (all frames/largest angle): " + ", ".join(low))
    if args.peer:
        peer(mine)
    if args.plot:
        plotted(args.plot, name, mine)


def scored_generated(name: str, args: argparse.Namespace, work: Path) -> None:
    """One line of the table for a generated sequence."""
    number = [*GENERATED, name].index(name)
    figure, _, motion = name.partition(":")
    figure, motion = (name, "") if figure == "random" else (figure, motion)
    contacts = [{"limb": a, "target": b, "begin": c, "end": d} for a, b, c, d in GENERATED.get(name, ())]
    synth = {"figure": figure, "motion": motion or None, "contacts": contacts, "seed": number}
    synth |= {"frames": 24, "vertices": 5000, "noise": 0.001}
    source = {"synth": synth, "frames": f"::{args.every}"}
    mine = aligned(source, work / f"{name.replace(':', '-')}-{number}-{args.every}", args.sets)
    true = skinned_motion(mine.recipe, mine.V, mine.frames, mine.start)
    error = np.linalg.norm(mine.x - true, axis=2) / height(mine.recipe) * 100
    part = parts(mine.recipe, mine.V, mine.frames[mine.start])
    limbs = max(error[:, part == p].mean(axis=1).max() for p in np.unique(part) if (part == p).sum() > 10)
    figures = f"{error.mean():7.3f} {np.quantile(error, 0.95):6.2f} {error.max():6.1f} {limbs:6.1f}"
    print(f"{name:12s} {mine.cells()} {figures}", flush=True)
    if args.plot:
        plotted(args.plot, name.replace(":", "-"), mine)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--data", type=Path)
    where.add_argument("--generated", action="store_true")
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--reference", type=int)
    parser.add_argument("--set", action="append", default=[], dest="sets", metavar="TASK.NAME=VALUE")
    parser.add_argument("--work", type=Path)
    parser.add_argument("--peer", action="store_true")
    parser.add_argument("--plot", type=Path)
    args = parser.parse_args()
    args.sets += [] if args.reference is None else [f"reference.frame={args.reference}"]
    with tempfile.TemporaryDirectory() as scratch:
        work = (args.work or Path(scratch)).absolute()
        if args.generated:
            print("figure        ref  frm  s/frm resid%  uncov  ?   mean%   p95%   max%  limb%")
            for name in args.only or GENERATED:
                scored_generated(name, args, work)
            return
        print("sequence   ref  frm  s/frm resid%  uncov  ?   mean%   p95%   max%  joints turning ≥ 0.8")
        for name in args.only or ["wave", "dance", "wolf", "camel", "dancer"]:
            scored(args.data, name, args, work)


if __name__ == "__main__":
    main()
