"""Both papers' methods on the same silhouettes: joints found, error, spurious ones, R_detection and E_dist (2009, Sec. 4).

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/silhouettes.py [--data FOLDER] [--only NAME ...] [--seeds 1,2,3] [--presets reeb default paper-2009]
                                     [--cameras 15] [--size 512] [--voxels 128] [--work FOLDER]

FOLDER holds NAME.npz beside NAME.truth.json, as for `accuracy.py`; `wave` and `wolf` are taken unless --only names others,
about 18 frames of each at even steps. Generated humans are those of `accuracy.py`, every second of 36 frames of 6,000
vertices. Masks are rendered as by `kinetree silhouettes`; all presets read the same ones. `reeb` is the default of the 2009
method, `default` that of the 2014 method, `paper-2009` the older paper to the letter. --work keeps masks and stores, so that
a second call computes what changed.
"""

import argparse
import json
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from accuracy import MOTIONS, Case, scored, seeds_of, varied

from kinetree.schemas.input.synth import SynthParams
from kinetree.schemas.results.evaluation import Evaluation, Summary
from kinetree.tasks.commands.silhouettes import silhouettes
from kinetree.tasks.input.synth import body, recipe

FRAMES = 18
"""About how many frames of a recorded sequence are used."""
HEADS = ("sequence", "frames", "preset", "found", "mean error, %", "spurious", "R_detection", "E_dist, %")


@dataclass(frozen=True)
class Masks:
    """How silhouettes are rendered and carved."""

    cameras: int
    size: int
    voxels: int


def recorded(folder: Path, names: Sequence[str], masks: Masks, work: Path) -> Iterator[Case]:
    """Sequences of a folder, about `FRAMES` frames of each."""
    for name in names:
        truth = folder.absolute() / f"{name}.truth.json"
        step = max(1, round(len(json.loads(truth.read_text())["positions"]) / FRAMES))
        yield _case(name, folder.absolute() / f"{name}.npz", f"::{step}", truth, masks, work)


def generated(seeds: Sequence[int], masks: Masks, work: Path) -> Iterator[Case]:
    """Humans of other proportions, every second of 36 frames."""
    for seed in seeds:
        meshes = work / f"human-{seed}"
        if not (meshes / "truth.json").exists():
            _write_meshes(seed, meshes)
        yield _case(f"human-{seed}", meshes / "frame_*.ply", "::2", meshes / "truth.json", masks, work)


def _write_meshes(seed: int, folder: Path) -> None:
    """A human's meshes, and its truth last."""
    import trimesh

    folder.mkdir(parents=True, exist_ok=True)
    figure = folder / "figure.yaml"
    figure.write_text(yaml.safe_dump(varied("human", seed)))
    motion = MOTIONS["human"][seed % len(MOTIONS["human"])]
    human = body(recipe(SynthParams(file=str(figure), motion=motion, frames=36, vertices=6000, seed=seed)))
    for frame in range(36):
        trimesh.Trimesh(*human.frame(frame), process=False).export(folder / f"frame_{frame:04d}.ply")
    (folder / "truth.json").write_text(json.dumps(human.truth()))


def _case(name: str, meshes: Path, frames: str, truth: Path, masks: Masks, work: Path) -> Case:
    """A sequence of masks, rendered unless it is there."""
    folder = work / f"{name}-{masks.cameras}-{masks.size}-masks"
    if not folder.exists():
        silhouettes(str(meshes), folder, cameras=masks.cameras, size=masks.size, frames=frames)
    blocks = {"source": {"input": str(folder)}, "truth": {"file": str(truth)}, "hull": {"resolution": masks.voxels}}
    return Case(name, name, blocks)


def row(case: Case, preset: str, evaluation: Evaluation, why: str) -> str:
    """A line of the table."""
    s = evaluation.summary or Summary()
    error = "–" if s.percent is None else f"{s.percent:.2f}"
    cells: tuple[Any, ...] = (
        case.name, len(evaluation.frames), preset, f"{s.found} of {s.scored}", error, s.spurious, f"{s.detection:.2f}",
        f"{100 * s.distance:.1f}",
    )  # fmt: skip
    return "| " + " | ".join(map(str, cells)) + " |" + (f" FAILED {why}" if why else "")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--only", nargs="+", default=["wave", "wolf"])
    parser.add_argument("--seeds", type=seeds_of, default=[1, 2, 3], help="0-9, or 1,2,3, or none")
    parser.add_argument("--presets", nargs="+", default=["reeb", "default"])
    parser.add_argument("--cameras", type=int, default=15)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--voxels", type=int, default=128)
    parser.add_argument("--work", type=Path)
    args = parser.parse_args()
    masks = Masks(args.cameras, args.size, args.voxels)
    with tempfile.TemporaryDirectory() as scratch:
        work = (args.work or Path(scratch)).absolute()
        work.mkdir(parents=True, exist_ok=True)
        print("| " + " | ".join(HEADS) + " |", "|" + "---|" * len(HEADS), sep="\n", flush=True)
        sequences = [*(recorded(args.data, args.only, masks, work) if args.data else ()), *generated(args.seeds, masks, work)]
        for case in sequences:
            for preset in args.presets:
                evaluation, _, why = _run(case, preset, work)
                print(row(case, preset, evaluation, why), flush=True)


def _run(case: Case, preset: str, work: Path) -> tuple[Evaluation, float, str]:
    """One run; `reeb` is a method and not a preset."""
    if preset != "reeb":
        return scored(case, preset, work)
    blocks = {**case.blocks, "method": "reeb"}
    return scored(Case(f"{case.name}-reeb", case.group, blocks), "default", work)


if __name__ == "__main__":
    main()
