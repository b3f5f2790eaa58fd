"""Several takes of one body against each take alone: joints found, errors, spurious ones, bone lengths.

    python benchmarks/takes.py [--seeds 0 1 2] [--frames 16] [--vertices 2000] [--trunk wave bow] [--work FOLDER]

A person of other proportions for every seed is seen in three takes: in one only the arms turn, in one only the legs, in one
only the trunk. In the second and third the body stands elsewhere and faces another way. `--trunk wave` turns the trunk as the
figure's own motion does: the spine by 18° and the chest back by 22°, about one axis, and the head about its own. `--trunk bow`
turns each joint of the trunk by 30° at a time of its own, about an axis across it.
"""

import argparse
import json
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
import yaml
from accuracy import varied
from scipy.spatial.transform import Rotation

from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.input.frame_numbers import TAKE

TAKES = {"arms": ("shoulder", "elbow", "wrist"), "legs": ("hip_", "knee", "ankle"), "trunk": ("spine", "chest", "neck", "head")}
PLACES = (((0, 0, 0), 0), ((900, -400, 0), 100), ((-300, 700, 100), -35))
"""Where the body stands in each take, in the figure's unit, and which way it faces, degrees."""
FPS = 16.0


def motions(figure: dict[str, Any], trunk: str, seconds: float) -> dict[str, Any]:
    """One motion for every take: the figure's own waving in some joints, the others held."""
    own = dict(figure["motions"]["wave"])
    if trunk == "bow":
        for number, joint in enumerate(TAKES["trunk"]):
            begin, step = number * seconds / 5, seconds / 5
            keys = [[begin, 0], [begin + step / 2, 30], [begin + step, 0]]
            own[joint] = [{"axis": [1, 0, 0] if number % 2 == 0 else [0, 1, 0], "keys": keys}]
    held = {joint: [_held(curve) for curve in curves] for joint, curves in own.items()}
    return {take: {j: own[j] if j.startswith(names) else held[j] for j in own} for take, names in TAKES.items()}


def _held(curve: dict[str, Any]) -> dict[str, Any]:
    return {**curve, "keys": [[0, 0], [1, 0]]} if "keys" in curve else {**curve, "amplitude": 0}


def write(seed: int, trunk: str, frames: int, vertices: int, folder: Path) -> None:
    """The takes of one person as folders of meshes, each with its truth, and the truth of all beside them."""
    figure = varied("human", seed)
    figure["motions"] = motions(figure, trunk, frames / FPS)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "figure.yaml").write_text(yaml.safe_dump(figure))
    told: dict[str, Any] = {}
    for k, (take, (shift, degrees)) in enumerate(zip(TAKES, PLACES, strict=True)):
        told_of = {
            "file": str(folder / "figure.yaml"),
            "motion": take,
            "frames": frames,
            "vertices": vertices,
            "fps": FPS,
            "seed": seed,
        }
        made = body(recipe(SynthParams.model_validate(told_of)))
        R = Rotation.from_euler("z", degrees, degrees=True).as_matrix()
        (folder / take).mkdir()
        for t in range(frames):
            V, F = made.frame(t)
            trimesh.Trimesh(V @ R.T + shift, F, process=False).export(folder / take / f"frame_{t:04d}.ply")
        own = made.truth()
        own["positions"] = (np.array(own["positions"]) @ R.T + shift).tolist()
        (folder / take / "truth.json").write_text(json.dumps(own))
        numbers = [k * TAKE + t for t in range(frames)]
        if not told:
            told = {**own, "frames": numbers}
        else:
            told |= {"frames": told["frames"] + numbers, "positions": told["positions"] + own["positions"]}
            for joint, other in zip(told["joints"], own["joints"], strict=True):
                joint["turns_deg"] = max(joint.get("turns_deg", 0.0), other.get("turns_deg", 0.0))
                joint["scored"] = bool(joint["scored"] or other["scored"])
    (folder / "truth.json").write_text(json.dumps(told))


def scored(source: dict[str, Any], truth: Path, output: Path, store: Path) -> tuple[list[str], Any]:
    """The cells of one run, and its skeleton."""
    pipeline = Pipeline.of({"source": source, "truth": {"file": str(truth)}, "output": str(output), "store": str(store)})
    told = pipeline.run(until=["evaluation"])
    if told["status"] != "done":
        return [told["failures"][0]["message"] if told["failures"] else told["status"]], None
    found: Any = pipeline.artifact("evaluation")
    s = found.summary
    missing = ", ".join(joint.name for joint in found.joints if joint.scored and joint.found is None)
    mean = "–" if s.percent is None else f"{s.percent:.2f} %"
    return [f"{s.found} of {s.scored}", mean, f"{s.spurious} spurious", f"missing: {missing or 'none'}"], pipeline.artifact(
        "skeleton"
    )


def main() -> None:
    """Prints a line a run, then how many joints all bodies have in sum."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--frames", type=int, default=16, help="of each take")
    parser.add_argument("--vertices", type=int, default=2000)
    parser.add_argument("--trunk", nargs="+", choices=("wave", "bow"), default=["wave", "bow"])
    parser.add_argument("--alone", action="store_true", help="each take by itself as well")
    parser.add_argument("--work", type=Path)
    told = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        work = told.work or Path(folder)
        for trunk in told.trunk:
            for seed in told.seeds:
                place = work / f"{trunk}-{seed}"
                if not (place / "truth.json").exists():
                    write(seed, trunk, told.frames, told.vertices, place)
                takes = [{"name": take, "input": str(place / take)} for take in TAKES]
                cells, skeleton = scored({"takes": takes}, place / "truth.json", place / "out", work / "store")
                print(f"{trunk} {seed} all".ljust(16), *cells, sep="  ", flush=True)
                if skeleton is not None:
                    print(" " * 16, f"bone lengths vary by {_variation(skeleton):.1g}", flush=True)
                for take in TAKES if told.alone else ():
                    own = {"input": str(place / take)}
                    cells, _ = scored(own, place / take / "truth.json", place / f"out-{take}", work / "store")
                    print(f"{trunk} {seed} {take}".ljust(16), *cells, sep="  ", flush=True)


def _variation(skeleton: Any) -> float:
    """Largest relative difference of a bone's length between frames of all takes."""
    X, parents = np.asarray(skeleton.positions), np.array(skeleton.parents)
    child = np.flatnonzero(parents >= 0)
    lengths = np.linalg.norm(X[:, child] - X[:, parents[child]], axis=2)
    return float((np.ptp(lengths, axis=0) / lengths.mean(axis=0)).max())


if __name__ == "__main__":
    main()
