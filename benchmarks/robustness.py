"""What noise, holes, losses, contacts and strangers in the picture do to the result, and whether the run says so.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/robustness.py [--figures human quadruped random] [--seeds 1] [--frames 16] [--vertices 2000]
                                    [--data FOLDER --sequences NAME ...] [--only KIND ...] [--preset default]
                                    [--work FOLDER] [--again] [--json FILE] [--markdown]

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
verdict is that they are not to be used. A refusal counts as noticed. With --work a second call goes on where the first one
stopped; --again judges what is there anew, after the verdict was changed.
"""

import argparse
import json
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import fast_simplification
import numpy as np
import trimesh
from accuracy import varied

from kinetree.errors import KinetreeError
from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.results.evaluation import Summary
from kinetree.tasks.numerics.arrays import Faces, Floats
from kinetree.tasks.numerics.input.source import read_npz
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.defects import punctured, roughened
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.trees import random_tree

MOTION_FRAMES = 36
"""Frames at the figure's own rate that a generated clip covers."""
HOLES = 3
"""Holes in every frame."""
OFF = 5.0
"""From how far on a joint is off, % of the height."""
CONTACT = {"limb": "hand_r", "target": "hip_r"}
Mesh = tuple[Floats, Faces]


@dataclass(frozen=True)
class Clip:
    """Meshes by frame number, and the true skeleton, whose positions are those of the frames 0, 1, 2, …"""

    name: str
    meshes: dict[int, Mesh]
    truth: dict[str, Any]
    body: Body | None = None

    @cached_property
    def height(self) -> float:
        """Of the body, in its own unit."""
        return float(self.truth["height"])

    @cached_property
    def tips(self) -> list[int]:
        """Joints that nothing hangs on, the farthest from the root last."""
        joints, X = self.truth["joints"], np.array(self.truth["positions"])[0]
        parents = {joint["parent"] for joint in joints}
        ends = [j for j, joint in enumerate(joints) if joint["name"] not in parents and j not in parents]
        return sorted(ends, key=lambda j: float(np.linalg.norm(X[j] - X[0])))

    def each(self, change: Callable[[int, Mesh], Mesh]) -> "Clip":
        """With every mesh changed."""
        return replace(self, meshes={t: change(t, mesh) for t, mesh in self.meshes.items()})


def generated(figure: str, seed: int, frames: int, vertices: int) -> Clip:
    """A body in motion, surfaced anew in every frame."""
    return of_body(f"{figure}-{seed}", _posed(figure, seed, frames, vertices))


def of_body(name: str, body: Body) -> Clip:
    """The clip that a generated body makes."""
    return Clip(name, {t: body.frame(t) for t in range(len(body.X))}, body.truth(), body)


def recorded(folder: Path, name: str) -> Clip:
    """A sequence of a file."""
    frames = read_npz(folder / f"{name}.npz")
    return Clip(name, {t: frames.mesh(t) for t in range(len(frames))}, json.loads((folder / f"{name}.truth.json").read_text()))


def _posed(figure: str, seed: int, frames: int, vertices: int, **options: Any) -> Body:
    made = random_tree(seed) if figure == "random" else Figure.of(varied(figure, seed))
    return Body.of(made, frames=frames, vertices=vertices, seed=seed, fps=made.fps * frames / MOTION_FRAMES, **options)


# ── what is done to a clip ──────────────────────────────────────────────────────────────────────────────────────────


def noise(clip: Clip, sigma: float) -> Clip:
    """Rough surfaces."""
    return clip.each(lambda t, m: (roughened(*m, sigma * clip.height, 0.1 * clip.height, _rng(clip, t)), m[1]))


def holes(clip: Clip, radius: float) -> Clip:
    """Three holes in every frame."""
    return clip.each(lambda t, m: _int32(punctured(*m, HOLES, radius * clip.height, _rng(clip, t))))


def frames(clip: Clip, share: float) -> Clip:
    """Some frames are not there; the first and the last stay."""
    inner = list(clip.meshes)[1:-1]
    lost = set(_rng(clip, 0).choice(inner, size=round(share * len(clip.meshes)), replace=False).tolist())
    return replace(clip, meshes={t: mesh for t, mesh in clip.meshes.items() if t not in lost})


def rate(clip: Clip, share: float) -> Clip:
    """Fewer frames a second."""
    step = round(1 / share)
    truth = {**clip.truth, "positions": clip.truth["positions"][::step], "fps": clip.truth["fps"] * share}
    return replace(clip, meshes=dict(enumerate(list(clip.meshes.values())[::step])), truth=truth)


def vertices(clip: Clip, share: float) -> Clip:
    """Coarser meshes."""
    return clip.each(lambda _, m: _int32(fast_simplification.simplify(m[0], m[1], target_reduction=1 - share)))


def limb(clip: Clip, count: int) -> Clip:
    """One limb is cut off in the middle of the clip."""
    joints, cut = clip.truth["joints"], set(_chain(clip)[:2])
    ends = np.array([[j, _index(joints, joint["parent"])] for j, joint in enumerate(joints) if joint["parent"] is not None])

    def without(t: int, mesh: Mesh) -> Mesh:
        if t not in _middle(clip, count):
            return mesh
        X = np.array(clip.truth["positions"][t])
        nearest = ends[np.argmin(_segment_distances(mesh[0], X[ends[:, 1]], X[ends[:, 0]]), axis=1), 0]
        return _kept(mesh, ~np.isin(nearest, list(cut))[mesh[1]].any(axis=1))

    return clip.each(without)


def contact(clip: Clip, count: int) -> Clip:
    """A hand grows together with the hip."""
    assert clip.body is not None
    middle, (figure, seed) = _middle(clip, count), clip.name.split("-")
    touch = {**CONTACT, "begin": middle.start, "end": middle.stop - 1, "ramp": 3}
    return of_body(clip.name, _posed(figure, int(seed), len(clip.meshes), clip.body.vertices, contacts=[touch]))


def bodies(clip: Clip, _: int) -> Clip:
    """Two of them, the second a few frames ahead."""
    numbers, width = list(clip.meshes), max(float(np.ptp(V[:, 0])) for V, _ in clip.meshes.values())

    def doubled(t: int, mesh: Mesh) -> Mesh:
        other = clip.meshes[numbers[(numbers.index(t) + 3) % len(numbers)]]
        return _joined(mesh, (other[0] + [1.5 * width, 0, 0], other[1]))

    return clip.each(doubled)


def carried(clip: Clip, radius: float) -> Clip:
    """A ball at the end of a limb."""
    ball, tip = trimesh.creation.icosphere(subdivisions=2, radius=radius * clip.height), clip.tips[-1]
    return clip.each(lambda t, m: _joined(m, (ball.vertices + clip.truth["positions"][t][tip], ball.faces)))


def clothes(clip: Clip, sigma: float) -> Clip:
    """Long waves over the surface, others in every frame."""
    return clip.each(lambda t, m: (m[0] + _waves(m[0], sigma * clip.height, clip.height / 3, _rng(clip, t)), m[1]))


KINDS: dict[str, tuple[Callable[[Clip, Any], Clip], tuple[float, ...]]] = {
    "none": (lambda clip, _: clip, (0,)),
    "noise": (noise, (0.00067, 0.0015, 0.003, 0.005)),
    "holes": (holes, (0.02, 0.04, 0.08)),
    "frames": (frames, (0.1, 0.3)),
    "rate": (rate, (0.5, 0.25)),
    "vertices": (vertices, (0.25, 0.05)),
    "limb": (limb, (1, 3, 6)),
    "contact": (contact, (2, 4, 8)),
    "bodies": (bodies, (2,)),
    "object": (carried, (0.05, 0.1)),
    "clothes": (clothes, (0.005, 0.01, 0.02)),
}


def _rng(clip: Clip, t: int) -> np.random.Generator:
    return np.random.default_rng([len(clip.meshes), t])


def _int32(mesh: tuple[Any, Any]) -> Mesh:
    return np.asarray(mesh[0], dtype=np.float64), np.asarray(mesh[1], dtype=np.int32)


def _middle(clip: Clip, count: int) -> range:
    begin = (len(clip.meshes) - int(count)) // 2
    return range(begin, begin + int(count))


def _index(joints: list[dict[str, Any]], parent: Any) -> int:
    return parent if isinstance(parent, int) else next(j for j, joint in enumerate(joints) if joint["name"] == parent)


def _chain(clip: Clip) -> list[int]:
    """Joints from the farthest tip towards the root."""
    joints, chain = clip.truth["joints"], [clip.tips[-1]]
    while joints[chain[-1]]["parent"] not in (None, -1):
        chain.append(_index(joints, joints[chain[-1]]["parent"]))
    return chain


def _segment_distances(V: Floats, A: Floats, B: Floats) -> Floats:
    """(vertex, bone)"""
    along = B - A
    share = np.einsum("vbx,bx->vb", V[:, None] - A, along) / np.maximum((along**2).sum(axis=1), 1e-12)
    return np.linalg.norm(V[:, None] - A - np.clip(share, 0, 1)[..., None] * along, axis=2)


def _kept(mesh: Mesh, faces: Any) -> Mesh:
    used, F = np.unique(mesh[1][faces], return_inverse=True)
    return _int32((mesh[0][used], F.reshape(-1, 3)))


def _joined(a: Mesh, b: Mesh) -> Mesh:
    return _int32((np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1] + len(a[0])])))


def _waves(V: Floats, sigma: float, wavelength: float, rng: np.random.Generator) -> Floats:
    """A smooth field of vectors of root mean square `sigma`."""
    k = rng.normal(size=(3, 16)) * (2 * np.pi / wavelength / np.sqrt(3.0))
    field = np.cos(V @ k + rng.uniform(0, 2 * np.pi, 16)) @ rng.normal(size=(16, 3))
    return sigma * field / np.sqrt((field**2).sum(axis=1).mean())


# ── what became of it ───────────────────────────────────────────────────────────────────────────────────────────────


def measured(clip: Clip, work: Path, label: str, preset: str) -> dict[str, Any]:
    """What one run is worth, and what it remarked."""
    folder = work / "clips" / label
    folder.mkdir(parents=True, exist_ok=True)
    for t, (V, F) in clip.meshes.items():
        (folder / f"frame_{t:04d}.ply").write_bytes(trimesh.Trimesh(V, F, process=False).export(file_type="ply"))
    (folder / "truth.json").write_text(json.dumps(clip.truth))
    told = {
        "source": {"input": str(folder)}, "truth": {"file": str(folder / "truth.json")}, "store": str(work / "store"),
        "output": str(work / "runs" / label), **({} if preset == "default" else {"extends": preset}),
    }  # fmt: skip
    try:
        pipeline = Pipeline.of(told)
        run = pipeline.run(until=["evaluation", "verdict"])
        if run["status"] != "done":
            return {"refused": run["failures"][0]["message"]}
        found: Any = pipeline.artifact("evaluation")
        judged: Any = pipeline.artifact("verdict")
    except KinetreeError as error:
        return {"refused": str(error)}
    s = found.summary or Summary()
    percent = {
        str(joint.found): 100 * float(np.nanmax(found.error[:, j])) / found.height
        for j, joint in enumerate(found.joints) if joint.scored and joint.found is not None
    }  # fmt: skip
    return {
        "refused": "", "found": s.found, "scored": s.scored, "percent": s.percent, "spurious": list(found.spurious),
        "lost": [joint.name for joint in found.joints if joint.scored and joint.found is None],
        "strayed": {name: worst for name, worst in percent.items() if worst > OFF},
        "verdict": judged.level, "findings": [finding.model_dump(mode="json") for finding in judged.findings],
    }  # fmt: skip


def off(row: dict[str, Any]) -> bool:
    """Whether a joint of the result is where no true joint is, or strays from its partner in some frame."""
    return bool(row["spurious"] or row["strayed"])


def noticed(row: dict[str, Any]) -> bool:
    """Whether the run says that something is not to be relied on."""
    return bool(row["refused"] or row["verdict"] != "good")


def measure(clips: list[Clip], kinds: list[str], work: Path, preset: str, again: bool) -> Iterator[dict[str, Any]]:
    """One row a clip, kind and level; those of an earlier call are read."""
    kept = work / "rows.jsonl"
    if again:
        kept.unlink(missing_ok=True)
    rows = [json.loads(line) for line in kept.read_text().splitlines()] if kept.exists() else []
    there = {(row["clip"], row["kind"], row["level"]): row for row in rows}
    for kind in ["none", *(k for k in kinds if k != "none")]:
        spoil, levels = KINDS[kind]
        for level in levels:
            for clip in clips:
                if kind == "contact" and not clip.name.startswith("human-"):
                    continue
                row = there.get((clip.name, kind, level))
                if row is None:
                    label = f"{clip.name}-{kind}-{level:g}"
                    row = {"clip": clip.name, "kind": kind, "level": level,
                           **measured(spoil(clip, level), work, label, preset)}  # fmt: skip
                    with kept.open("a", encoding="utf-8") as file:
                        file.write(json.dumps(row, ensure_ascii=False) + "\n")
                yield row


def summed(rows: list[dict[str, Any]], markdown: bool = False) -> Iterator[str]:
    """A line for every kind and level, over all clips, and one over all of them."""
    head = (
        "kind",
        "level",
        "found",
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
        cells = (
            kind, "" if level is None else f"{level:g}", f"{sum(r['found'] for r in done)}/{sum(r['scored'] for r in done)}",
            f"{np.mean(percents):.2f}" if percents else "–", sum(len(r["spurious"]) for r in done),
            f"{len(mine) - len(done)}/{len(mine)}", *(f(runs) for runs in (wrong, missed, right) for f in (len, _noticed)),
            sum(row["verdict"] == "unusable" for row in done),
        )  # fmt: skip
        yield ("| " + " | ".join(map(str, cells)) + " |") if markdown else "  ".join(f"{c!s:>9s}" for c in cells)


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
    parser.add_argument("--only", nargs="*", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--preset", default="default")
    parser.add_argument("--work", type=Path)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--markdown", action="store_true")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = (args.work or Path(scratch)).absolute()
        work.mkdir(parents=True, exist_ok=True)
        clips = [recorded(args.data, name) for name in args.sequences]
        clips += [generated(f, s, args.frames, args.vertices) for s in range(args.seeds) for f in args.figures]
        rows = []
        for row in measure(clips, args.only, work, args.preset, args.again):
            rows.append(row)
            print(row["clip"], row["kind"], f"{row['level']:g}", _line(row), sep="  ", flush=True)
        print(*summed(rows, args.markdown), sep="\n")
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1, ensure_ascii=False))


if __name__ == "__main__":
    main()
