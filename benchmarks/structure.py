"""Joints out of aligned vertices, stage by stage, against the truth; seconds a frame; a peer in the same run.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/structure.py [--data FOLDER] [--aligned FOLDER] [--only NAME ...] [--seeds 10] [--frames 36]
                                   [--vertices 4000] [--slide 0.005] [--noise 0.00067] [--peer 20 30]

Connectivity is fixed, so that what is measured is Step III alone. FOLDER of --data may hold NAME-body.npz (vertices, faces,
vertex_offsets) beside NAME-body.truth.json; that of --aligned NAME.npz (x, V, F) with the truth in the other. Generated are
humans, quadrupeds and random trees, so many seeds of each, of other proportions; --seeds 0 leaves them out. --slide moves
every vertex by a smooth random displacement of that share of the height, correlated over 5 % of it: a harsh picture of an
alignment's error. --noise moves every coordinate of every vertex by a normal deviate of that share of the height (2014,
Fig. 21: 1 mm of 1,500) and prints how far joints have come, in % of the height, and how many are new or gone.

Stages: `tree`, all parts in a tree; `pruned`, after those that are none were dropped; `fitted`, the finished skeleton with
bones of one length. --peer gives Dem Bones (py-dem-bones) that many bones and joins them in the same tree with the same
joints. Found are joints within 5 % of the height, assigned as `kinetree evaluate` does; errors in % of the height.
Seconds are the processor's, after a first run that compiles.
"""

import argparse
import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from accuracy import MOTIONS, varied

from kinetree.schemas.structure.kinematic_tree import KinematicTreeParams
from kinetree.schemas.structure.rigid_parts import RigidPartsParams
from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.trees import random_tree
from kinetree.tasks.numerics.results.evaluation.matching import joint_errors, matching
from kinetree.tasks.numerics.structure.first_tree import first_tree
from kinetree.tasks.numerics.structure.kinematic_tree import kinematic_tree
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree, part_tree
from kinetree.tasks.numerics.structure.pruning import pruned
from kinetree.tasks.numerics.structure.rigid_parts import rigid_parts
from kinetree.tasks.numerics.structure.tree_joints import Cut
from kinetree.tasks.numerics.topology.extrema import extrema
from kinetree.tasks.numerics.topology.geodesics import farthest_bases, mu
from kinetree.tasks.structure.first_tree import tree_settings
from kinetree.tasks.structure.rigid_parts import parts_settings

PARTS, TREE = parts_settings(RigidPartsParams()), tree_settings(KinematicTreeParams())

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Case:
    """Aligned vertices x (frame, vertex, xyz) of a reference V, F, and what is true of them."""

    name: str
    group: str
    V: Floats
    F: Ints
    x: Floats
    truth: dict[str, Any]

    @property
    def height(self) -> float:
        return float(self.truth["height"])


@dataclass(frozen=True)
class Score:
    """Joints found and to be found, mean error of the found in % of the height, spurious ones, names of those missed."""

    found: int
    scored: int
    error: float
    spurious: int
    missed: list[str]


def recorded(data: Path, aligned: Path | None) -> Iterator[Case]:
    """Bodies with true trajectories, and what an alignment made of the meshes surfaced from them."""
    for path in sorted(data.glob("*-body.npz")):
        name = path.name.removesuffix(".npz")
        told = data / f"{name}.truth.json"
        if told.exists():
            held = np.load(path)
            x = held["vertices"].astype(np.float64).reshape(len(held["vertex_offsets"]) - 1, -1, 3)
            yield Case(name, "bodies", x[0], held["faces"].astype(np.int64), x, json.loads(told.read_text()))
    for path in sorted(aligned.glob("*.npz")) if aligned else []:
        told = data / f"{path.stem}.truth.json"
        if told.exists():
            held = np.load(path)
            yield Case(path.stem, "aligned", held["V"], held["F"].astype(np.int64), held["x"], json.loads(told.read_text()))


def generated(seeds: int, frames: int, vertices: int) -> Iterator[Case]:
    """Humans, quadrupeds and random trees of fixed connectivity."""
    for seed in range(seeds):
        for name, motions in MOTIONS.items():
            motion = motions[seed % len(motions)]
            yield made(f"{name}-{seed}", name, Figure.of(varied(name, seed)), motion, seed, frames, vertices)
        yield made(f"random-{seed}", "random", random_tree(seed), None, seed, frames, vertices)


def made(name: str, group: str, figure: Figure, motion: str | None, seed: int, frames: int, vertices: int) -> Case:
    body = Body.of(figure, motion=motion, frames=frames, vertices=vertices, connectivity="fixed", seed=seed)
    meshes = [body.frame(t) for t in range(frames)]
    x = np.stack([V for V, _ in meshes])
    return Case(name, group, x[0], meshes[0][1].astype(np.int64), x, body.truth())


def slid(case: Case, share: float) -> Case:
    """The same with every vertex displaced smoothly, anew in every frame."""
    rng = np.random.default_rng(0)
    centre = case.V[rng.choice(len(case.V), 600)]
    reach = np.exp(-((case.V[:, None] - centre[None]) ** 2).sum(axis=2) / (2 * (0.05 * case.height) ** 2))
    reach /= np.sqrt((reach**2).sum(axis=1, keepdims=True)) + 1e-12
    away = np.einsum("vn,tnx->tvx", reach, rng.normal(size=(len(case.x), 600, 3))) * share * case.height / np.sqrt(3)
    return Case(case.name, case.group, case.V, case.F, case.x + away, case.truth)


def roughened(case: Case, share: float) -> Case:
    """The same with noise of its own at every vertex in every frame, the reference among them."""
    x = case.x + np.random.default_rng(0).normal(size=case.x.shape) * share * case.height
    return Case(case.name, case.group, x[0], case.F, x, case.truth)


def displaced(case: Case, quiet: Floats, rough: Floats) -> str:
    """How far joints (frame, joint, xyz) are from the nearest ones after noise."""
    apart = 100.0 * np.linalg.norm(quiet[:, :, None] - rough[:, None], axis=3).mean(axis=0) / case.height
    there, back = apart.min(axis=1), apart.min(axis=0)
    worst = " ".join(f"{far:.2f}" for far in np.sort(there[there <= 5.0])[::-1][:3])
    stay = f"{(there <= 0.5).sum()} of {len(there)} within 0.5 %"
    return f"{case.name:16s} noise      {stay}, worst {worst}, gone {(there > 5.0).sum()}, new {(back > 5.0).sum()}"


def score(case: Case, X: Floats) -> Score:
    """What joints X (frame, joint, xyz) are worth."""
    told = case.truth["joints"]
    true = [i for i, joint in enumerate(told) if joint["kind"] == "joint"]
    Y = np.array(case.truth["positions"], dtype=np.float64)[:, true]
    scored = np.array([bool(told[i]["scored"]) for i in true])
    may = np.ones((X.shape[1], len(true)), dtype=bool)
    claims = np.ones(X.shape[1], dtype=bool)
    found = matching(X, Y, may, scored=scored, can_be_spurious=claims, limit=0.05 * case.height)
    hit = scored & (found.partner >= 0)
    error = 100.0 * np.nanmean(joint_errors(X, Y, found.partner)[:, hit]) / case.height if hit.any() else np.nan
    missed = [str(told[i]["name"]) for i, s, h in zip(true, scored, hit, strict=True) if s and not h]
    return Score(int(hit.sum()), int(scored.sum()), float(error), len(found.spurious), missed)


def carried(held: MovingParts, tree: PartTree) -> Floats:
    """(frame, joint, xyz) the joints of a tree as the parts above them carry them."""
    order, rows = tree.tree.order, tree.tree.border[1:]
    above = order[tree.tree.parents[1:]]
    return np.einsum("tpxy,py->tpx", held.R[:, above], tree.joints.rest[rows]) + held.t[:, above]


def stages(case: Case) -> tuple[dict[str, Floats], float, float]:
    """Joints after every stage, and seconds a frame of the parts and of all that follows."""
    kept, faces, _ = largest_component(case.V, case.F.astype(np.int32))
    bases = farthest_bases(Surface.of(case.V[kept], faces), 100)
    tips = kept[extrema(mu(bases.distance, bases.weight), faces).vertex]
    area = Surface.of(case.V, case.F).area
    begun = time.process_time()
    confidence = np.ones(case.x.shape[:2]) if case.group == "aligned" else None
    found = rigid_parts(case.V, case.F, case.x, confidence, leaves=tips, settings=PARTS)
    parted = time.process_time()
    body, cut = MovingSurface(case.V, case.F, case.x, area), Cut(case.V, found.label, found.R, found.t, found.residual)
    skeleton, _ = kinematic_tree(body, first_tree(body, cut, tips, confidence, settings=TREE), tips, confidence, settings=TREE)
    done = time.process_time()
    held = MovingParts(*cut[1:])
    left = pruned(body, held, tips, settings=TREE.pruning)
    turning = np.array([kind == "joint" for kind in skeleton.kinds])
    joints = {
        "tree": carried(held, part_tree(body, held)),
        "pruned": carried(left.parts, left.part_tree),
        "fitted": skeleton.positions[:, turning],
    }
    return joints, (parted - begun) / len(case.x), (done - parted) / len(case.x)


def peer(case: Case, bones: int) -> tuple[Floats, float]:
    """Joints of Dem Bones' bones in the same tree with the same centres, and seconds a frame of its own part."""
    from py_dem_bones import solve_skinning

    begun = time.process_time()
    solved = solve_skinning(case.V, case.x, bones, faces=case.F.tolist())
    seconds = (time.process_time() - begun) / len(case.x)
    label = np.asarray(solved.weights).argmax(axis=0)
    used, label = np.unique(label, return_inverse=True)
    moved = np.asarray(solved.transforms)[:, used]
    held = MovingParts(label.astype(np.int64), moved[..., :3, :3].copy(), moved[..., :3, 3].copy(), np.zeros(moved.shape[:2]))
    body = MovingSurface(case.V, case.F, case.x, Surface.of(case.V, case.F).area)
    return carried(held, part_tree(body, held)), seconds


def told(name: str, stage: str, s: Score, seconds: str) -> str:
    counts = f"{s.found:3d}/{s.scored:<3d} {s.error:6.2f} {s.spurious:+4d}"
    return f"{name:16s} {stage:10s} {counts}  {seconds:16s} {' '.join(s.missed)}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--aligned", type=Path)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--frames", type=int, default=36)
    parser.add_argument("--vertices", type=int, default=4000)
    parser.add_argument("--slide", type=float, default=0.0)
    parser.add_argument("--noise", type=float, default=0.0)
    parser.add_argument("--peer", type=int, nargs="*", default=[])
    asked = parser.parse_args()
    stages(made("warm", "warm", random_tree(0), None, 0, 8, 1000))
    print(f"{'sequence':16s} {'stage':10s} {'found':7s} {'% err':>6s} spur  s/frame          missed")
    totals: dict[tuple[str, str], list[Score]] = {}
    cases = [recorded(asked.data, asked.aligned)] if asked.data else []
    for case in (c for source in [*cases, generated(asked.seeds, asked.frames, asked.vertices)] for c in source):
        if asked.only and case.name not in asked.only and case.group not in asked.only:
            continue
        case = slid(case, asked.slide) if asked.slide else case
        joints, parting, rest = stages(case)
        if asked.noise:
            print(displaced(case, joints["fitted"], stages(roughened(case, asked.noise))[0]["fitted"]), flush=True)
        rows = [(stage, X, f"{parting:.4f} + {rest:.4f}" if stage == "fitted" else "") for stage, X in joints.items()]
        for bones in asked.peer:
            X, seconds = peer(case, bones)
            rows.append((f"peer {bones}", X, f"{seconds:.4f}, ratio {seconds / max(parting + rest, 1e-9):.1f}"))
        for stage, X, seconds_told in rows:
            totals.setdefault((case.group, stage), []).append(score(case, X))
            print(told(case.name, stage, totals[case.group, stage][-1], seconds_told), flush=True)
    print()
    for (group, stage), rows_of in totals.items():
        found, scored = sum(s.found for s in rows_of), sum(s.scored for s in rows_of)
        error = np.nanmean([s.error for s in rows_of])
        spurious = np.mean([s.spurious for s in rows_of])
        share = 100 * found / max(scored, 1)
        print(f"{group:16s} {stage:10s} {found}/{scored} = {share:.1f} %, {error:.2f} %, {spurious:+.2f} a sequence")


if __name__ == "__main__":
    main()
