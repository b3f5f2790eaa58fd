"""Sliding along the surface and roll of limbs, with colours and without, on generated bodies that are painted.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/colour.py [FIGURE:MOTION ...] [--seeds N ...] [--twist] [--clothes patterned|plain] [--illumination X]
                                [--grain X] [--frames N] [--vertices N]

Every frame is surfaced anew and coloured at its own vertices. The truth is the same body skinned in every frame. Sliding is
the part of a vertex's error in the tangent plane, % of the body's height; roll is the angle about its own axis between a limb's
true points and its estimated ones (Kabsch), in all frames but the reference. `--twist` also turns limbs about their own axes by
25° to 50°, as people turn arms and heads, which the round limbs of most figures do not show. What is scored is what
`kinetree run` leaves. Seconds are those of the tasks of the shelf `registration`, a frame, one after the other.
"""

import argparse
import itertools
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from alignment import Aligned, aligned
from generated_truth import height, parts, skinned_motion
from scipy.spatial.transform import Rotation

from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.input.synth import recipe
from kinetree.tasks.numerics.geometry.normals import vertex_normals

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
TWISTED = ("shoulder", "elbow", "hip_", "knee", "neck")


def twisted(figure: dict[str, Any], seed: int) -> dict[str, Any]:
    """A figure whose limbs also turn about their own axes."""
    rng = np.random.default_rng(seed)
    figure = json.loads(json.dumps(figure))
    place = {j["name"]: np.array(j["position"], float) for j in figure["joints"]}
    for motion in figure["motions"].values():
        for joint in figure["joints"]:
            name, ends = joint["name"], [k["name"] for k in figure["joints"] if k.get("parent") == joint["name"]]
            if joint.get("parent") and len(ends) == 1 and any(t in name for t in TWISTED):
                axis = (place[ends[0]] - place[name]) / np.linalg.norm(place[ends[0]] - place[name])
                turn = {"amplitude": rng.uniform(25, 50), "frequency": rng.uniform(0.4, 0.9), "phase": rng.random()}
                motion.setdefault(name, []).append({"axis": [round(float(a), 6) for a in axis], **turn})
    return figure


def source(name: str, args: argparse.Namespace, seed: int, work: Path) -> dict[str, Any]:
    """The block of the configuration of a painted sequence."""
    figure, _, motion = name.partition(":")
    made, motion = (name, "") if figure in ("random", "adult") and motion.isdigit() else (figure, motion)
    synth: dict[str, Any] = {
        "figure": made, "motion": motion or None, "frames": args.frames, "vertices": args.vertices, "noise": 0.001,
        "seed": seed, "paint": args.clothes, "illumination": args.illumination, "grain": args.grain,
    }  # fmt: skip
    if args.twist:
        file = work / f"{name.replace(':', '-')}-{seed}.yaml"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(twisted(json.loads(recipe(SynthParams.model_validate(synth)))["figure"], seed)))
        synth["file"] = str(file)
    return {"synth": synth}


def scores(mine: Aligned) -> tuple[Floats, Floats]:
    """(frame, vertex) sliding, % of the height · (limb and frame,) roll that is wrong, degrees."""
    start, true, part = mine.start, *_truth(mine)
    N = np.stack([vertex_normals(x, mine.F) for x in true])
    off = mine.x - true
    off -= np.einsum("tvx,tvx->tv", off, N)[..., None] * N
    rolls = []
    for number in np.unique(part):
        member = part == number
        if member.sum() < 25:
            continue
        P = true[start][member]
        axis = np.linalg.svd(P - P.mean(axis=0), full_matrices=False)[2][0]
        for t in [t for t in range(len(true)) if t != start]:
            turn = _turn(P, true[t][member]).T @ _turn(P, mine.x[t][member])
            rolls.append(abs(np.degrees(Rotation.from_matrix(turn).as_rotvec() @ axis)))
    return np.linalg.norm(off, axis=2) / height(mine.recipe) * 100, np.array(rolls)


def _truth(mine: Aligned) -> tuple[Floats, Ints]:
    """(frame, vertex, xyz) true trajectories · (vertex,) part."""
    true = skinned_motion(mine.recipe, mine.V, mine.frames, mine.start)
    return true, parts(mine.recipe, mine.V, mine.frames[mine.start])


def _turn(P: Floats, Q: Floats) -> Floats:
    """The rotation that takes P to Q by least squares (Kabsch)."""
    U, _, Vt = np.linalg.svd((Q - Q.mean(axis=0)).T @ (P - P.mean(axis=0)))
    U[:, 2] *= np.sign(np.linalg.det(U @ Vt))
    return np.asarray(U @ Vt)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", default=["human:walk", "human:wave", "quadruped:"])
    parser.add_argument("--seeds", type=int, nargs="*", default=[0])
    parser.add_argument("--twist", action="store_true")
    parser.add_argument("--clothes", default="patterned")
    parser.add_argument("--illumination", type=float, default=0.0)
    parser.add_argument("--grain", type=float, default=0.01)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--vertices", type=int, default=3000)
    args = parser.parse_args()
    print("figure        seed colours  sliding mean%   p95%   roll mean°  >10° %  >20° %   s/frm")
    with tempfile.TemporaryDirectory() as scratch:
        for name, seed, use in itertools.product(args.names, args.seeds, ("never", "auto")):
            work = Path(scratch) / f"{name.replace(':', '-')}-{seed}"
            sets = [f"reference.frame={args.frames // 2}", f"vertex_colour.use={use}"]
            mine = aligned(source(name, args, seed, work), work, sets)
            slide, roll = scores(mine)
            line = f"{name:13s} {seed:4d} {'–' if use == 'never' else 'used':7s} {slide.mean():14.3f}"
            line += f" {np.quantile(slide, 0.95):6.2f} {roll.mean():12.1f} {(roll > 10).mean() * 100:7.1f}"
            print(line + f" {(roll > 20).mean() * 100:7.1f} {mine.seconds:7.2f}", flush=True)


if __name__ == "__main__":
    main()
