"""A rigged body in the motions of generated people, surfaced anew in every frame: anatomy that no capsule has.

    python benchmarks/rigged.py RIG.npz FOLDER MOTION:SEED ... [--frames 36] [--spacing 0.0107] [--noise 0.00067] [--fixed]

RIG.npz holds V_rest (vertex, xyz), F (face, corner), W (vertex, joint), names and parents (joint,), head (joint, xyz), y up and
x to the left, with the joints' names of the CMU motion capture database, as bodies made with MakeHuman can have. FOLDER then
holds rigSEEDMOTION.npz and rigSEEDMOTION.truth.json, which `python benchmarks/accuracy.py --data FOLDER --seeds none` scores.
Each bone of the body turns as the bone of `adult:SEED` that stands for it, collar bones by a fifth of what the upper arm turns.
--spacing is that of the grid on which a frame is surfaced, --noise that along the normals, shares of the height. --fixed keeps
the body's own vertices, without noise.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import yaml
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from kinetree.tasks.input.synth import PEOPLE
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.inside import inside
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.input.hull import Field
from kinetree.tasks.numerics.input.isosurface import isosurface
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.people import person
from kinetree.tasks.numerics.input.synth.surfacing import largest_component

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

HEIGHT = 1500.0
SCORED = 15.0  # degrees that a joint turns, at least, to be scored
UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # people stand along z
TRUNK = {
    "Hips": ("hips", 1.0), "LowerBack": ("spine", 0.5), "Spine": ("spine", 1.0), "Spine1": ("chest", 1.0),
    "Neck": ("neck", 0.5), "Neck1": ("neck", 1.0), "Head": ("head", 1.0),
}  # fmt: skip
LIMBS = {
    "Shoulder": ("shoulder", 0.2), "Arm": ("shoulder", 1.0), "ForeArm": ("elbow", 1.0), "Hand": ("wrist", 1.0),
    "UpLeg": ("hip", 1.0), "Leg": ("knee", 1.0), "Foot": ("ankle", 1.0), "ToeBase": ("ball", 1.0),
}  # fmt: skip
SIDES = {"Left": "l", "Right": "r"}
TURNS_AS = TRUNK | {f"{side}{bone}": (f"{j}_{s}", share) for bone, (j, share) in LIMBS.items() for side, s in SIDES.items()}
"""The joint of a person that a bone turns as, and by which share of its turn against its parent; 1 is its turn in the world."""
POINTS = {
    "Arm": ("ForeArm", "shoulder", "elbow"), "ForeArm": ("Hand", "elbow", "wrist"), "Hand": ("FingerBase", "wrist", "hand"),
}  # fmt: skip
"""Bones that hang otherwise at rest: where each points, and from where to where that of a person does."""


class Rig(NamedTuple):
    """A body at rest, HEIGHT tall."""

    names: list[str]
    parents: Ints
    head: Floats
    V: Floats
    F: Ints
    W: Floats

    @classmethod
    def of(cls, path: Path) -> "Rig":
        """Of a file."""
        held = np.load(path)
        scale = HEIGHT / float(np.ptp(held["V_rest"][:, 1]))
        names = [str(name) for name in held["names"]]
        V, head, W = held["V_rest"] * scale, held["head"] * scale, held["W"].astype(np.float64)
        return cls(names, held["parents"].astype(np.int64), head, V, held["F"].astype(np.int64), W)


class Clip(NamedTuple):
    """V (frame, vertex, xyz) · X (frame, joint, xyz) · turns (joint,) the widest against the parent, degrees · fps."""

    V: Floats
    X: Floats
    turns: Floats
    fps: float


def posed(rig: Rig, motion: str, seed: int, frames: int) -> Clip:
    """The body as a person moves."""
    figure = Figure.of(person(yaml.safe_load((PEOPLE / "adult.yaml").read_text("utf-8")), motion, seed))
    body = Body.of(figure, motion=motion, frames=frames, seed=seed)
    world = _world(rig, figure, UPRIGHT @ body.G @ UPRIGHT.T)
    X = np.zeros((frames, len(rig.names), 3))
    moved = (body.X[:, 0] - figure.rest[0]) @ UPRIGHT.T * HEIGHT / figure.height
    for k, p in enumerate(rig.parents.tolist()):
        X[:, k] = rig.head[k] + moved if p < 0 else X[:, p] + world[:, p] @ (rig.head[k] - rig.head[p])
    V = np.zeros((frames, *rig.V.shape))
    for k, weight in enumerate(rig.W.T):
        own = np.flatnonzero(weight)
        V[:, own] += weight[own, None] * ((rig.V[own] - rig.head[k]) @ world[:, k].swapaxes(1, 2) + X[:, k, None])
    local = world[:, np.maximum(rig.parents, 0)].swapaxes(2, 3) @ world
    return Clip(V, X, np.array([0.0 if p < 0 else widest(local[:, k]) for k, p in enumerate(rig.parents)]), body.fps)


def _world(rig: Rig, figure: Figure, G: Floats) -> Floats:
    """(frame, joint, 3, 3) of the rig's bones; G (frame, joint, 3, 3) of the person's."""
    names, rest = list(figure.names), figure.rest @ UPRIGHT.T
    world = np.tile(np.eye(3), (len(G), len(rig.names), 1, 1))
    for k, (name, p) in enumerate(zip(rig.names, rig.parents.tolist(), strict=True)):
        if name not in TURNS_AS:
            world[:, k] = world[:, p]
            continue
        joint, share = TURNS_AS[name]
        j = names.index(joint)
        if share < 1.0:
            against = Rotation.from_matrix(G[:, figure.parents[j]].swapaxes(1, 2) @ G[:, j])
            world[:, k] = world[:, p] @ Rotation.from_rotvec(share * against.as_rotvec()).as_matrix()
            continue
        world[:, k] = G[:, j]
        side = next((side for side in SIDES if name.startswith(side)), "")
        if bone := POINTS.get(name.removeprefix(side)):
            end, begin, to = rig.names.index(f"{side}{bone[0]}"), *(names.index(f"{n}_{SIDES[side]}") for n in bone[1:])
            world[:, k] = G[:, j] @ _towards(rig.head[end] - rig.head[k], rest[to] - rest[begin])
    return world


def _towards(a: Floats, b: Floats) -> Floats:
    """(3, 3) the least turn that takes one direction to another."""
    return np.asarray(Rotation.align_vectors(b[None], a[None])[0].as_matrix())


def widest(R: Floats) -> float:
    """The largest angle between two of some rotations (frame, 3, 3), degrees."""
    Q = Rotation.from_matrix(R)
    return float(np.degrees(max((Q * one.inv()).magnitude().max() for one in Q)))


def surfaced(V: Floats, F: Ints, spacing: float, noise: float, rng: np.random.Generator) -> tuple[Floats, Ints]:
    """A body as a reconstruction has it: on a grid of its own, what touches as one; lengths in the body's unit."""
    low = V.min(axis=0) - spacing * (3.0 + rng.uniform(size=3))
    count = np.ceil((V.max(axis=0) - low) / spacing).astype(np.int64) + 4
    P = low + spacing * np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), axis=-1).reshape(-1, 3)
    far = np.full(len(P), 3.0 * spacing)
    near = np.flatnonzero(np.isfinite(KDTree(V).query(P, distance_upper_bound=4.0 * spacing)[0]))
    far[near] = np.minimum(projected(P[near], V, F).distance, far[near])
    values = np.where(inside(P, V, F), far, -far).reshape(count).astype(np.float32)
    every, corners = isosurface(Field(values, low, np.full(3, spacing)))
    vertices, faces = largest_component(every, corners.astype(np.int64))
    return vertices + rng.normal(0.0, noise, len(vertices))[:, None] * vertex_normals(vertices, faces), faces


def truth_of(rig: Rig, clip: Clip) -> Mapping[str, Any]:
    """As `kinetree evaluate` reads it."""
    joints = [
        {
            "name": name,
            "parent": rig.names[p] if p >= 0 else None,
            "kind": "joint",
            "turns_deg": float(turns),
            "scored": bool(p >= 0 and turns >= SCORED),
        }
        for name, p, turns in zip(rig.names, rig.parents.tolist(), clip.turns, strict=True)
    ]
    return {"unit": "mm", "height": HEIGHT, "joints": joints, "positions": clip.X.tolist()}


def write(
    path: Path, meshes: Sequence[tuple[Floats, Ints]], truth: Mapping[str, Any], fps: float, *, fixed: bool = False
) -> None:
    """Writes a sequence and its true joints; fixed: all frames have the faces of the first."""
    faces = meshes[:1] if fixed else meshes
    np.savez(
        path.with_suffix(".npz"),
        vertices=np.concatenate([V for V, _ in meshes]).astype(np.float32),
        faces=np.concatenate([F for _, F in faces]).astype(np.int32),
        vertex_offsets=np.cumsum([0, *(len(V) for V, _ in meshes)]),
        face_offsets=np.cumsum([0, *(len(F) for _, F in faces)]),
        fps=fps,
        unit=str(truth["unit"]),
        name=path.name,
    )
    path.with_suffix(".truth.json").write_text(json.dumps(truth))


def named(text: str) -> tuple[str, int]:
    """A motion and a seed."""
    motion, _, seed = text.partition(":")
    if not seed.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is no MOTION:SEED, e.g. walk:301")
    return motion, int(seed)


def main() -> None:
    """Reads the command line and writes the sequences."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("rig", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("clips", type=named, nargs="+", metavar="MOTION:SEED")
    parser.add_argument("--frames", type=int, default=36)
    parser.add_argument("--spacing", type=float, default=0.0107)
    parser.add_argument("--noise", type=float, default=0.00067)
    parser.add_argument("--fixed", action="store_true")
    args = parser.parse_args()
    rig = Rig.of(args.rig)
    args.folder.mkdir(parents=True, exist_ok=True)
    for motion, seed in args.clips:
        clip, rng = posed(rig, motion, seed, args.frames), np.random.default_rng(seed)
        sizes = args.spacing * HEIGHT, args.noise * HEIGHT
        meshes = [(V, rig.F) if args.fixed else surfaced(V, rig.F, *sizes, rng) for V in clip.V]
        name = f"rig{seed}{motion}"
        write(args.folder / name, meshes, truth_of(rig, clip), clip.fps, fixed=args.fixed)
        print(f"{name}: {args.frames} frames of {len(meshes[0][0])} vertices", flush=True)


if __name__ == "__main__":
    main()
