"""One mesh aligned to all frames, against the truth: vertex error, turning of every joint, seconds a frame, residual.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/alignment.py --data FOLDER [--only NAME ...] [--every N] [--reference FRAME] [--peer] [--plot FOLDER]
    python benchmarks/alignment.py --generated [--only FIGURE ...] [--every N] [--plot FOLDER]

FOLDER holds sequences NAME.npz (vertices, faces, vertex_offsets, face_offsets); where NAME-body.npz and NAME.truth.json
lie beside them, errors are given in % of the body's height; elsewhere residuals only, in % of the body's size. Seconds
are those the processor spent, all on one core, after a first fit that compiles. --every N refits and scores each Nth
frame only (tracking needs
all). --peer aligns one frame with trimesh's nricp_amberg too and gives the ratio.

--generated scores bodies that kinetree makes itself, with contacts and noise: a figure, its motion and its seed, or
random:SEED for random trees. The truth is the same body skinned in every frame; `limb` is the largest mean error of one
limb in one frame: a limb that sits on another has tens of percent.
"""

import argparse
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt
import trimesh
from turning import Truth, with_roll

from kinetree.schemas.input.synth import ContactParams, SynthParams
from kinetree.schemas.registration.deformation_graph import DeformationGraphParams
from kinetree.schemas.registration.tracking import TrackingParams
from kinetree.tasks.input.synth import body as posed
from kinetree.tasks.input.synth import recipe
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.input.mesh import Cleaned, clean
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph, deformation_graph
from kinetree.tasks.numerics.registration.first_fit import first_fit
from kinetree.tasks.numerics.registration.frame_confidence import inliers, residuals
from kinetree.tasks.numerics.registration.near_pose import (
    NearPose,
    distant_points,
    is_lost,
    near_pose,
    thinned_body,
    thinned_frame,
)
from kinetree.tasks.numerics.registration.recovery import recovery
from kinetree.tasks.numerics.registration.reference import profile, reference
from kinetree.tasks.numerics.registration.rigid_clusters import rigid_clusters
from kinetree.tasks.numerics.registration.stiffness import PASSES, learned_stiffness, loose_between_clusters, loose_limb_ends
from kinetree.tasks.numerics.registration.tracking import Tracking, tracking
from kinetree.tasks.numerics.topology.extrema import extrema, stems
from kinetree.tasks.numerics.topology.geodesics import farthest_bases, mu
from kinetree.tasks.numerics.topology.leaves import follow
from kinetree.tasks.numerics.topology.mu_histogram import dimensionless
from kinetree.tasks.registration.deformation_graph import graph_settings
from kinetree.tasks.registration.pose import fit_settings

GRAPH, FITTING = graph_settings(DeformationGraphParams()), fit_settings(TrackingParams())
Floats = npt.NDArray[np.float64]

# figure:motion, or random:SEED, and per contact: limb, target, first and last frame
GENERATED: dict[str, tuple[tuple[str, str, int, int], ...]] = {
    "human:walk": (("hand_r", "hip_r", 6, 12),),
    "human:wave": (("hand_l", "hip_l", 12, 18),),
    "human:squat": (),
    "quadruped:": (),
    "bird:": (),
    **{f"random:{seed}": () for seed in range(5)},
}


def frames(path: Path) -> list[Cleaned]:
    """Every frame of a sequence, clean."""
    held = np.load(path)
    V, F, v, f = (held[k] for k in ("vertices", "faces", "vertex_offsets", "face_offsets"))
    same = len(f) == 2
    return [
        clean(V[v[t] : v[t + 1]].astype(np.float64), F[f[0 if same else t] : f[1 if same else t + 1]].astype(np.int32))
        for t in range(len(v) - 1)
    ]


def generated(name: str, number: int) -> tuple[list[Cleaned], Body, Body]:
    """Every frame of a generated sequence, clean, its body, and the same body as one skinned mesh."""
    figure, _, motion = name.partition(":")
    made, motion = (name, "") if figure == "random" else (figure, motion)
    contacts = tuple(ContactParams(limb=a, target=b, begin=c, end=d) for a, b, c, d in GENERATED.get(name, ()))
    told = SynthParams(
        figure=made, motion=motion or None, frames=24, vertices=5000, contacts=contacts, noise=0.001, seed=number
    )
    seen = posed(recipe(told))
    skinned = posed(recipe(told.model_copy(update={"connectivity": "fixed", "noise": 0.0})))
    return [clean(*seen.frame(t)) for t in range(len(seen.X))], seen, skinned


def chosen(meshes: list[Cleaned]) -> int:
    """The reference frame by the rule."""
    poses, own, value, centre = [], [], [], []
    for mesh in meshes:
        surface = Surface.of(mesh.V, mesh.F)
        bases = farthest_bases(surface, 60)
        integral = mu(bases.distance, bases.weight)
        found = extrema(integral, mesh.F)
        poses.append(profile(integral, surface.area))
        own.append(stems(mesh.V, mesh.F, integral, surface.area, found))
        value.append(dimensionless(integral, surface.area)[found.vertex])
        centre.append(surface.area @ mesh.V / surface.area.sum())
    count, area = [len(x) for x in own], np.array([m.area for m in meshes])
    rows = follow(own, value, np.sqrt(area), np.stack(centre))
    limbs = np.full((len(rows), len(meshes), *own[0].shape[1:]), np.nan)
    for leaf, t in np.argwhere(rows >= 0):
        limbs[leaf, t] = own[t][rows[leaf, t]]
    return reference(count, [m.euler for m in meshes], area, np.stack(poses), limbs).frame


def chain(body: DeformationGraph, meshes: list[Cleaned], targets: list[Target], start: int) -> list[Tracking]:
    """Near poses outwards from the reference in both directions, and every frame fitted from its own."""
    out = [Tracking(at_rest(body), 0.0, 0)] * len(targets)
    cloud = thinned_body(body)
    for step in (1, -1):
        before, last, t, usual = None, at_rest(body), start + step, 0.0
        while 0 <= t < len(targets):
            points = thinned_frame(meshes[t].V, meshes[t].F, body.size)
            near = near_pose(cloud, last, points)
            if targets[t].colour is not None or is_lost(near, usual):
                out[t] = tracking(body, before, last, targets[t], FITTING, usual, distant=usual)
                near = NearPose(out[t].pose, distant_points(cloud, out[t].pose, points))
            else:
                out[t] = first_fit(body, near.pose, targets[t], FITTING, usual)
            usual = near.distant if before is None else min(usual, near.distant)
            before, last, t = last, near.pose, t + step
    return out


def aligned(meshes: list[Cleaned], start: int, every: int) -> tuple[DeformationGraph, list[int], list[Pose], Floats, float]:
    """All passes: the graph, the frames kept, their poses, uncovered shares, and seconds a frame."""
    body = deformation_graph(meshes[start].V, meshes[start].F, GRAPH)
    fit(body, at_rest(body), Target.of(meshes[start].V, meshes[start].F, body.size), FITTING)
    begun = time.process_time()
    targets = [Target.of(m.V, m.F, body.size) for m in meshes]
    chained = chain(body, meshes, targets, start)
    shares = np.array([frame.uncovered for frame in chained])
    again = recovery(body, shares, lambda t: chained[t].pose, targets.__getitem__, start, FITTING).recovered
    found = [again.get(t, frame) for t, frame in enumerate(chained)]
    first = (time.process_time() - begun) / len(meshes)
    kept = sorted({start, *range(0, len(meshes), every)})
    poses = [found[t].pose for t in kept]
    begun = time.process_time()
    limb = cluster = np.full(len(body.node), -1)
    for number, settings in enumerate(PASSES):
        s = loose_limb_ends(body, learned_stiffness(body, poses), limb)
        s = loose_between_clusters(body, s, cluster) if settings.is_loosened else s
        poses = [fit(body, pose, targets[t], settings.fit, s).pose for t, pose in zip(kept, poses, strict=True)]
        if not number:
            cluster = rigid_clusters(body, poses)
            poses, limb = with_roll(body, cluster, poses, [targets[t] for t in kept], kept.index(start))
    seconds = first + (time.process_time() - begun) / len(kept)
    return body, kept, poses, np.array([found[t].uncovered for t in kept]), seconds


def peer(meshes: list[Cleaned], body: DeformationGraph, start: int, seconds: float) -> None:
    """One frame by trimesh's nricp_amberg, in the same run."""
    source = trimesh.Trimesh(body.V, body.F, process=False)
    mesh = meshes[start + 1]
    begun = time.process_time()
    found = trimesh.registration.nricp_amberg(source, trimesh.Trimesh(mesh.V, mesh.F, process=False))
    spent = time.process_time() - begun
    error = residuals(np.asarray(found), mesh.V, mesh.F).mean() / body.size * 100
    print(f"    nricp_amberg: {spent:.1f} s for one frame, residual {error:.3f} %: {spent / seconds:.0f} times as long")


def plotted(
    folder: Path, name: str, body: DeformationGraph, shapes: list[Floats], meshes: list[Cleaned], kept: list[int]
) -> None:
    """Aligned (red) over input (grey) for six frames, three views."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    picked = np.linspace(0, len(kept) - 1, 6).astype(int)
    figure, axes = plt.subplots(2, 6, figsize=(24, 11))
    for column, k in enumerate(picked):
        for row, (a, b) in enumerate(((0, 1), (2, 1))):
            ax = axes[row, column]
            ax.scatter(*meshes[kept[k]].V[:, [a, b]].T, s=0.4, c="0.6")
            ax.triplot(*shapes[k][:, [a, b]].T, body.F[::4], lw=0.15, color="r")
            ax.set_aspect("equal")
            ax.set_title(f"{name} {kept[k]}")
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / f"{name}.png", dpi=60)


def scored(folder: Path, name: str, args: argparse.Namespace) -> None:
    """One line of the table, and the joints that turn too little."""
    meshes = frames(folder / f"{name}.npz")
    start = chosen(meshes) if args.reference is None else args.reference
    body, kept, poses, share, seconds = aligned(meshes, start, args.every)
    shapes = [shape(body, pose)[0] for pose in poses]
    residual = np.array([residuals(x, meshes[t].V, meshes[t].F).mean() for x, t in zip(shapes, kept, strict=True)])
    doubted = int((~inliers(share, residual)).sum())
    line = f"{name:9s} {start:4d} {len(kept):4d} {seconds:6.2f} {residual.mean() / body.size * 100:6.3f}"
    line += f" {share.max():6.3f} {doubted:3d}"
    low: list[str] = []
    if (folder / f"{name}-body.npz").exists():
        truth = Truth.of(folder, name, body.V, start)
        truth_kept = Truth(truth.x[kept], truth.part, truth.label, truth.joints, truth.height)
        error = np.linalg.norm(np.stack(shapes) - truth_kept.x, axis=2) / truth.height * 100
        turns = truth_kept.turns(np.stack(shapes), kept.index(start))
        low = [f"{t.joint} {t.share:.2f}/{t.peak:.2f} of {t.degrees:.0f}°" for t in turns if min(t.share, t.peak) < 0.8]
        line += f" {error.mean():7.3f} {np.quantile(error, 0.95):6.2f} {error.max():6.1f}"
        line += f" {len(turns) - len(low):3d}/{len(turns)}"
    print(line, flush=True)
    if low:
        print("    turning below 0.8 (all frames/largest angle): " + ", ".join(low))
    if args.peer:
        peer(meshes, body, start, seconds)
    if args.plot:
        plotted(args.plot, name, body, shapes, meshes, kept)


def scored_generated(name: str, number: int, args: argparse.Namespace) -> None:
    """One line of the table for a generated sequence."""
    meshes, seen, skinned = generated(name, number)
    start = chosen(meshes) if args.reference is None else args.reference
    rest, kept, poses, share, seconds = aligned(meshes, start, args.every)
    shapes = np.stack([shape(rest, pose)[0] for pose in poses])
    residual = np.array([residuals(x, meshes[t].V, meshes[t].F).mean() for x, t in zip(shapes, kept, strict=True)])
    skin = np.stack([skinned.frame(t)[0] for t in kept])
    F = skinned.skin.F
    on = projected(rest.V, skin[kept.index(start)], F)
    true = np.einsum("vk,tvkx->tvx", on.share, skin[:, F[on.face]])
    error = np.linalg.norm(shapes - true, axis=2) / seen.figure.height * 100
    part = seen.parts(start, rest.V)
    limbs = max(error[:, part == p].mean(axis=1).max() for p in np.unique(part) if (part == p).sum() > 10)
    told = f"{name:12s} {start:4d} {len(kept):4d} {seconds:6.2f} {residual.mean() / rest.size * 100:6.3f} {share.max():6.3f}"
    doubted = int((~inliers(share, residual)).sum())
    told += f" {doubted:3d} {error.mean():7.3f} {np.quantile(error, 0.95):6.2f} {error.max():6.1f} {limbs:6.1f}"
    print(told, flush=True)
    if args.plot:
        plotted(args.plot, name.replace(":", "-"), rest, list(shapes), meshes, kept)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--data", type=Path)
    where.add_argument("--generated", action="store_true")
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--reference", type=int)
    parser.add_argument("--peer", action="store_true")
    parser.add_argument("--plot", type=Path)
    args = parser.parse_args()
    if args.generated:
        print("figure        ref  frm  s/frm resid%  uncov  ?   mean%   p95%   max%  limb%")
        for number, name in enumerate(args.only or GENERATED):
            scored_generated(name, number, args)
        return
    print("sequence   ref  frm  s/frm resid% uncov  ?   mean%   p95%   max%  joints turning ≥ 0.8")
    for name in args.only or ["wave", "dance", "wolf", "camel", "dancer"]:
        scored(args.data, name, args)


if __name__ == "__main__":
    main()
