"""A recorded body in motions that nobody recorded: each limb moves as it did, at another time and pace, surfaced anew.

    python benchmarks/recombined.py BODY.npz FOLDER SEED ... [--frames 36] [--rate 1] [--spacing 0.0107] [--noise 0.00067]

BODY.npz holds the trajectories of a body whose every vertex was followed, vertices (frame × vertex, xyz), faces, fps, and its
skinning weights (vertex, bone) with weight_names bone_A_B for the bone from joint jA to jB, as the wolf's does; BODY.truth.json
beside it its true joints. FOLDER then holds NAMESEED.npz and NAMESEED.truth.json, which `python benchmarks/accuracy.py --data
FOLDER --seeds none` scores. The body at rest is its first frame. --rate is the share of the frame rate that is kept: 0.25 moves
four frames at a time. --spacing is that of the grid on which a frame is surfaced, --noise that along the normals, shares of the
height. Limbs may pass through each other; what touches is surfaced as one.
"""

import argparse
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from rigged import SCORED, surfaced, widest, write
from scipy.spatial.transform import Rotation, Slerp

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

LIMB = 3
"""Bones of a chain that moves by itself, at least."""
PACE = (0.8, 1.2)
"""Range of a limb's pace, in that of the recording; half of them go backwards."""
UNHELD = 1e-9
"""Ridge of the least squares for bones that little skin follows alone, share of the mean of their diagonal."""


class Body(NamedTuple):
    """A body at rest and how its bones turned.

    V, F, W : (vertex, xyz) · (face, corner) · (vertex, bone)
    joint   : (bone,) that each hangs on
    end     : (bone,) joint that it leads to
    parent  : (bone,) −1 for the root
    X       : (joint, xyz) at rest
    turn    : (frame, bone, 3, 3) against the parent
    truth   : as `kinetree evaluate` reads it
    fps     : of the recording
    """

    V: Floats
    F: Ints
    W: Floats
    joint: Ints
    end: Ints
    parent: Ints
    X: Floats
    turn: Floats
    truth: dict[str, Any]
    fps: float

    @classmethod
    def of(cls, path: Path) -> "Body":
        """Of a file."""
        held, truth = np.load(path), json.loads(path.with_suffix(".truth.json").read_text())
        names, X = [row["name"] for row in truth["joints"]], np.array(truth["positions"])
        x, W = held["vertices"].astype(np.float64).reshape(len(X), -1, 3), held["weights"].astype(np.float64)
        ends = [[names.index(f"j{j}") for j in str(name).split("_")[1:]] for name in held["weight_names"]]
        joint, end = np.array(ends, np.int64).T
        parent, world = _parents(joint, end), _rotations(x, W)
        for k, (start, to) in enumerate(ends):
            world[:, k] = _along(world[:, k], X[:, to] - X[:, start])
        turn = np.where((parent < 0)[:, None, None], world, world[:, parent].swapaxes(2, 3) @ world)
        return cls(x[0], held["faces"].astype(np.int64), W, joint, end, parent, X[0], turn, truth, float(held["fps"]))


class Clip(NamedTuple):
    """V (frame, vertex, xyz) · X (frame, joint, xyz) · turns (joint,) the widest of a bone that hangs on it, degrees."""

    V: Floats
    X: Floats
    turns: Floats


def _parents(joint: Ints, end: Ints) -> Ints:
    """(bone,) the bone that each hangs on; of bones on the root's joint all hang on that with most bones beyond it."""
    parent = np.array([next(iter(np.flatnonzero(end == j).tolist()), -1) for j in joint])
    beyond = np.zeros(len(joint), np.int64)
    for k in range(len(joint)):
        while k >= 0:
            beyond[k] += 1
            k = int(parent[k])
    free = np.flatnonzero(parent < 0)
    root = free[beyond[free].argmax()]
    parent[free[free != root]] = root
    return parent


def _rotations(x: Floats, W: Floats) -> Floats:
    """(frame, bone, 3, 3) nearest rotations to the linear maps that blend to the trajectories, from the first frame.

    x (frame, vertex, xyz), W (vertex, bone)
    """
    count, bones = W.shape
    A = (W[:, :, None] * np.concatenate([x[0], np.ones((count, 1))], axis=1)[:, None]).reshape(count, -1)
    H = A.T @ A
    S = np.linalg.solve(H + UNHELD * np.trace(H) / len(H) * np.eye(len(H)), A.T @ x.transpose(1, 0, 2).reshape(count, -1))
    U, _, Vt = np.linalg.svd(S.reshape(bones, 4, len(x), 3).transpose(2, 0, 3, 1)[..., :3])
    U[..., -1] *= np.sign(np.linalg.det(U @ Vt))[..., None]
    return np.asarray(U @ Vt)


def _along(R: Floats, d: Floats) -> Floats:
    """(frame, 3, 3) rotations, each turned on until a bone points where it does; d (frame, xyz) from its joint to its end."""
    here, there = R @ d[0], d
    axis = np.cross(here, there)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, (here * there).sum(axis=1))
    return np.asarray(Rotation.from_rotvec(axis * (angle / np.maximum(sine, 1e-300))[:, None]).as_matrix() @ R)


def limbs(parent: Ints) -> Ints:
    """(bone,) which chain each is of: one begins where more than one chain of `LIMB` bones or more hangs on a bone."""
    order, beyond = _order(parent), np.ones(len(parent), np.int64)
    for k in reversed(order[1:]):
        beyond[parent[k]] += beyond[k]
    chain = np.zeros(len(parent), np.int64)
    for k in order[1:]:
        beside = np.flatnonzero(parent == parent[k])
        forks = (beyond[beside] >= LIMB).sum() > 1 and beyond[k] >= LIMB
        chain[k] = chain.max() + 1 if forks else chain[parent[k]]
    return chain


def _order(parent: Ints) -> list[int]:
    """The bones, each after that on which it hangs."""
    order = [int(np.flatnonzero(parent < 0)[0])]
    for k in order:
        order.extend(np.flatnonzero(parent == k).tolist())
    return order


def recombined(body: Body, seed: int, frames: int, rate: float) -> Clip:
    """The body as its limbs move, each from a moment of its own and at its own pace, to and fro over the recording."""
    rng, last = np.random.default_rng([seed, 77]), len(body.turn) - 1
    turn, chain = np.zeros((frames, *body.turn.shape[1:])), limbs(body.parent)
    for c in range(chain.max() + 1):
        pace = rng.uniform(*PACE) * rng.choice([-1.0, 1.0]) / rate
        at = np.abs((rng.uniform(0.0, last) + pace * np.arange(frames) + last) % (2 * last) - last)
        for k in np.flatnonzero(chain == c):
            turn[:, k] = Slerp(np.arange(last + 1), Rotation.from_matrix(body.turn[:, k]))(at).as_matrix()
    return posed(body, turn)


def posed(body: Body, turn: Floats) -> Clip:
    """The body with its bones turned against those on which they hang; turn (frame, bone, 3, 3)."""
    frames = len(turn)
    world, X = turn.copy(), np.tile(body.X, (frames, 1, 1))
    V, turns = np.zeros((frames, *body.V.shape)), np.zeros(len(body.X))
    for k in _order(body.parent):
        j, p = int(body.joint[k]), int(body.parent[k])
        if p >= 0:
            world[:, k] = world[:, p] @ turn[:, k]
            turns[j] = max(turns[j], widest(turn[:, k]))
        own = np.flatnonzero(body.W[:, k])
        V[:, own] += body.W[own, k, None] * ((body.V[own] - body.X[j]) @ world[:, k].swapaxes(1, 2) + X[:, j, None])
        X[:, body.end[k]] = X[:, j] + world[:, k] @ (body.X[body.end[k]] - body.X[j])
    return Clip(V, X, turns)


def truth_of(body: Body, clip: Clip) -> dict[str, Any]:
    """As `kinetree evaluate` reads it; joints that the recording does not score, as bases of fingers, are not scored."""
    scored = {row["name"]: bool(row["scored"]) for row in body.truth["joints"]}
    joints = [
        row | {"turns_deg": float(turns), "scored": scored[row["name"]] and bool(turns >= SCORED)}
        for row, turns in zip(body.truth["joints"], clip.turns, strict=True)
    ]
    return body.truth | {"joints": joints, "positions": clip.X.tolist()}


def main() -> None:
    """Reads the command line and writes the sequences."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("body", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("seeds", type=int, nargs="+", metavar="SEED")
    parser.add_argument("--frames", type=int, default=36)
    parser.add_argument("--rate", type=float, default=1.0)
    parser.add_argument("--spacing", type=float, default=0.0107)
    parser.add_argument("--noise", type=float, default=0.00067)
    args = parser.parse_args()
    body, stem = Body.of(args.body), args.body.stem.removesuffix("-body")
    height = float(body.truth["height"])
    args.folder.mkdir(parents=True, exist_ok=True)
    for seed in args.seeds:
        clip, rng = recombined(body, seed, args.frames, args.rate), np.random.default_rng(seed)
        meshes = [surfaced(V, body.F, args.spacing * height, args.noise * height, rng) for V in clip.V]
        name = f"{stem}{seed}"
        write(args.folder / name, meshes, truth_of(body, clip), body.fps * args.rate)
        print(f"{name}: {args.frames} frames of {len(meshes[0][0])} vertices", flush=True)


if __name__ == "__main__":
    main()
