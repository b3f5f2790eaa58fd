"""Several takes of one body against each take alone: joints found, errors, spurious ones, bone lengths.

    python benchmarks/takes.py [--figures adult human quadruped] [--seeds 0 1 2] [--frames 16] [--vertices 2000]
                               [--trunk own bow] [--head 1] [--alone] [--work FOLDER]

A body of other proportions for every seed is seen in three takes: in one only the arms or forelegs turn, in one only the legs,
in one only the trunk. In the second and third the body stands elsewhere and faces another way. `--trunk own` turns the trunk as
the figure's own motion does: the human's spine by 18° and its chest back by 22°, about one axis, and its head about its own.
`--trunk bow` turns each joint of the trunk by 30° at a time of its own, about an axis across it. Adults are the figures
adult:SEED, whose surfaces show how heads, hands and feet turn: their arms dance, their legs run, and their trunk looks around,
the head by up to 60° to either side. The human's head is round, so that its turn about its own axis moves no surface;
`--head 0.8` makes it so much narrower than deep.
"""

import argparse
import json
import shutil
import tempfile
from itertools import product
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

TAKES = {
    "adult": {
        "arms": ("shoulder", "elbow", "wrist"),
        "legs": ("hip_", "knee", "ankle", "ball"),
        "trunk": ("spine", "chest", "neck", "head"),
    },
    "human": {
        "arms": ("shoulder", "elbow", "wrist"),
        "legs": ("hip_", "knee", "ankle"),
        "trunk": ("spine", "chest", "neck", "head"),
    },
    "quadruped": {
        "forelegs": ("shoulder", "elbow", "wrist", "paw"),
        "hindlegs": ("hip_", "stifle", "hock", "foot"),
        "trunk": ("loin", "chest", "neck", "head", "tail_1", "tail_2"),
    },
}
"""Which joints turn in each take."""
MOTION = {"human": "wave", "quadruped": "walk"}
ADULT_MOTIONS = {"arms": "dance", "legs": "run", "trunk": "look"}
"""Which motion of the figure adult:SEED turns the joints of each take."""
ACROSS = {"adult": ([1, 0, 0], [0, 1, 0]), "human": ([1, 0, 0], [0, 1, 0]), "quadruped": ([1, 0, 0], [0, 0, 1])}
"""Axes across the trunk, which its joints bend about in turn."""
PLACES = (((0, 0, 0), 0), ((900, -400, 0), 100), ((-300, 700, 100), -35))
"""Where the body stands in each take, in the figure's unit, and which way it faces, degrees."""
FPS = 16.0


def motions(name: str, figure: dict[str, Any], trunk: str, seconds: float) -> dict[str, Any]:
    """One motion for every take: the figure's own in some joints, the others held."""
    if name == "adult":
        return {take: _of_person(figure, take, trunk, seconds) for take in TAKES[name]}
    own = dict(figure["motions"][MOTION[name]])
    if trunk == "bow":
        own |= _bow(name, seconds)
    still = {joint: [_stilled(curve) for curve in curves] for joint, curves in own.items()}
    return {take: {j: own[j] if j.startswith(names) else still[j] for j in own} for take, names in TAKES[name].items()}


def _bow(name: str, seconds: float) -> dict[str, Any]:
    """Each joint of the trunk turned by 30°, one after the other."""
    step = seconds / (len(TAKES[name]["trunk"]) + 1)
    turned = {}
    for number, joint in enumerate(TAKES[name]["trunk"]):
        keys = [[number * step, 0], [(number + 0.5) * step, 30], [(number + 1) * step, 0]]
        turned[joint] = [{"axis": ACROSS[name][number % 2], "keys": keys}]
    return turned


def _of_person(figure: dict[str, Any], take: str, trunk: str, seconds: float) -> dict[str, Any]:
    """What turns in one take of a person: the joints of that take as in one of its motions, no others."""
    own = figure["motions"][ADULT_MOTIONS[take]]
    if take == "trunk" and trunk == "bow":
        own = _bow("adult", seconds)
    return {joint: curves for joint, curves in own.items() if joint.startswith(TAKES["adult"][take])}


def person(seed: int) -> dict[str, Any]:
    """The figure adult:SEED with every motion that the takes need."""
    figures = [json.loads(recipe(SynthParams(figure=f"adult:{seed}", motion=m)))["figure"] for m in ADULT_MOTIONS.values()]
    return {**figures[0], "motions": {name: curves for figure in figures for name, curves in figure["motions"].items()}}


def _stilled(curve: dict[str, Any]) -> dict[str, Any]:
    return (
        {**curve, "keys": [[0, 0], [1, 0]]}
        if "keys" in curve
        else curve | {k: 0 for k in ("amplitude", "distance") if k in curve}
    )


def write(name: str, seed: int, trunk: str, head: float, frames: int, vertices: int, folder: Path) -> None:
    """The takes of one body as folders of meshes, each with its truth, and the truth of all beside them."""
    figure = person(seed) if name == "adult" else varied(name, seed)
    figure["motions"] = motions(name, figure, trunk, frames / FPS)
    for joint in figure["joints"]:
        if joint["name"] == "head_top" and head != 1:
            joint |= {"flatten": head, "side": [1, 0, 0]}
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "figure.yaml").write_text(yaml.safe_dump(figure))
    truth: dict[str, Any] = {}
    for k, (take, (shift, degrees)) in enumerate(zip(TAKES[name], PLACES, strict=True)):
        params = {
            "file": str(folder / "figure.yaml"),
            "motion": take,
            "frames": frames,
            "vertices": vertices,
            "fps": FPS,
            "seed": seed,
        }
        generated = body(recipe(SynthParams.model_validate(params)))
        R = Rotation.from_euler("z", degrees, degrees=True).as_matrix()
        (folder / take).mkdir()
        for t in range(frames):
            V, F = generated.frame(t)
            trimesh.Trimesh(V @ R.T + shift, F, process=False).export(folder / take / f"frame_{t:04d}.ply")
        own = generated.truth()
        own["positions"] = (np.array(own["positions"]) @ R.T + shift).tolist()
        (folder / take / "truth.json").write_text(json.dumps(own))
        numbers = [k * TAKE + t for t in range(frames)]
        if not truth:
            truth = {**own, "frames": numbers}
        else:
            truth |= {"frames": truth["frames"] + numbers, "positions": truth["positions"] + own["positions"]}
            for joint, other in zip(truth["joints"], own["joints"], strict=True):
                joint["turns_deg"] = max(joint.get("turns_deg", 0.0), other.get("turns_deg", 0.0))
                joint["scored"] = bool(joint["scored"] or other["scored"])
    (folder / "truth.json").write_text(json.dumps(truth))


def scored(source: dict[str, Any], truth: Path, output: Path, store: Path) -> tuple[list[str], Any, Any]:
    """The cells of one run, its evaluation's summary, and its skeleton."""
    pipeline = Pipeline.of({"source": source, "truth": {"file": str(truth)}, "output": str(output), "store": str(store)})
    run = pipeline.run(until=["evaluation"])
    if run["status"] != "done":
        return [run["failures"][0]["message"] if run["failures"] else run["status"]], None, None
    evaluation: Any = pipeline.artifact("evaluation")
    s = evaluation.summary
    missing = ", ".join(joint.name for joint in evaluation.joints if joint.scored and joint.found is None)
    mean = "–" if s.percent is None else f"{s.percent:.2f} %"
    cells = [f"{s.found} of {s.scored}", mean, f"{s.spurious} spurious", f"missing: {missing or 'none'}"]
    return cells, s, pipeline.artifact("skeleton")


def main() -> None:
    """Prints a line a run, then how many joints were found in all bodies together."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--figures", nargs="+", choices=tuple(TAKES), default=["human"])
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--frames", type=int, default=16, help="of each take")
    parser.add_argument("--vertices", type=int, default=2000)
    parser.add_argument("--trunk", nargs="+", choices=("own", "bow"), default=["own", "bow"])
    parser.add_argument("--head", type=float, default=1.0, help="width of the human's head, share of its depth")
    parser.add_argument("--alone", action="store_true", help="each take by itself as well")
    parser.add_argument("--work", type=Path)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        work = args.work or Path(folder)
        sums = [_measured(name, seed, trunk, args, work) for name, trunk, seed in product(args.figures, args.trunk, args.seeds)]
    print("sum".ljust(24), *(f"{sum(column)}" for column in zip(*sums, strict=True)), "(found, scored, spurious)", sep="  ")


def _measured(name: str, seed: int, trunk: str, args: argparse.Namespace, work: Path) -> tuple[int, int, int]:
    """Prints what all takes of a body give, and each alone; joints found, scored and spurious of all together."""
    place = work / "-".join([name, trunk, str(seed), *([f"{args.head:g}"] if args.head != 1 else [])])
    if not (place / "truth.json").exists():
        write(name, seed, trunk, args.head, args.frames, args.vertices, place)
    takes = [{"name": take, "input": str(place / take)} for take in TAKES[name]]
    cells, summary, skeleton = scored({"takes": takes}, place / "truth.json", place / "out", work / "store")
    print(f"{name} {trunk} {seed} all".ljust(24), *cells, sep="  ", flush=True)
    if skeleton is not None:
        print(" " * 24, f"bone lengths vary by {_variation(skeleton):.1g}", flush=True)
    for take in TAKES[name] if args.alone else ():
        own = {"input": str(place / take)}
        cells = scored(own, place / take / "truth.json", place / f"out-{take}", work / "store")[0]
        print(f"{name} {trunk} {seed} {take}".ljust(24), *cells, sep="  ", flush=True)
    return (0, 0, 0) if summary is None else (summary.found, summary.scored, summary.spurious)


def _variation(skeleton: Any) -> float:
    """Largest relative difference of a bone's length between frames of all takes."""
    X, parents = np.asarray(skeleton.positions), np.array(skeleton.parents)
    child = np.flatnonzero(parents >= 0)
    lengths = np.linalg.norm(X[:, child] - X[:, parents[child]], axis=2)
    return float((np.ptp(lengths, axis=0) / lengths.mean(axis=0)).max())


if __name__ == "__main__":
    main()
