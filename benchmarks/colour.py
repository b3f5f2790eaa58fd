"""Sliding along the surface and roll of limbs, with colours and without, on generated bodies that are painted.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/colour.py [FIGURE:MOTION ...] [--seeds N ...] [--twist] [--clothes patterned|plain] [--illumination X]
                                [--grain X] [--frames N] [--vertices N]

Every frame is surfaced anew and coloured at its own vertices. The truth is the same body skinned in every frame. Sliding is
the part of a vertex's error in the tangent plane, % of the body's height; roll is the angle about its own axis between a limb's
true points and its estimated ones (Kabsch), in all frames but the reference. `--twist` also turns limbs about their own axes by
25° to 50°, as people turn arms and heads, which the round limbs of most figures do not show. Seconds are those the processor
spent a frame on tracking and all passes, after a first fit that compiles.
"""

import argparse
import json
import time
from typing import Any

import alignment
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation
from turning import with_roll

from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.input.synth import body as posed
from kinetree.tasks.input.synth import paint, recipe
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.input.mesh import Cleaned, clean
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.registration.colour_term import FrameColour
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph, deformation_graph
from kinetree.tasks.numerics.registration.recovery import recovery
from kinetree.tasks.numerics.registration.rigid_clusters import rigid_clusters
from kinetree.tasks.numerics.registration.stiffness import PASSES, learned_stiffness, loose_between_clusters, loose_limb_ends

Floats = npt.NDArray[np.float64]
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


def sequence(name: str, args: argparse.Namespace, seed: int) -> tuple[list[Cleaned], list[Floats], Body, Body]:
    """Every frame of a generated sequence, clean, its colours, its body, and the same body as one skinned mesh."""
    figure, _, motion = name.partition(":")
    figure_name, motion = (name, "") if figure in ("random", "adult") and motion.isdigit() else (figure, motion)
    params = SynthParams(
        figure=figure_name, motion=motion or None, frames=args.frames, vertices=args.vertices, noise=0.001, seed=seed,
        paint=args.clothes, illumination=args.illumination, grain=args.grain,
    )  # fmt: skip
    options = json.loads(recipe(params))
    if args.twist:
        options["figure"] = twisted(options["figure"], seed)
    written = json.dumps(options, sort_keys=True)
    observed, colours = posed(written), paint(written)
    assert colours is not None
    meshes, frame_colours = [], []
    for t in range(args.frames):
        V, F = observed.frame(t)
        mesh = clean(V, F)
        own = np.round(255.0 * colours.colours(t, V, F)) / 255.0
        colour = np.zeros_like(mesh.V)
        colour[mesh.vertex_map[mesh.vertex_map >= 0]] = own[mesh.vertex_map >= 0]
        meshes.append(mesh)
        frame_colours.append(colour)
    return meshes, frame_colours, observed, colours.skinned


def aligned(meshes: list[Cleaned], start: int, colours: list[Floats] | None) -> tuple[DeformationGraph, list[Pose], float]:
    """All passes: the graph, the poses, and seconds a frame."""
    body = deformation_graph(meshes[start].V, meshes[start].F, alignment.GRAPH)
    fit(body, at_rest(body), _target(body, meshes, start, start, colours), alignment.FITTING)
    begun = time.process_time()
    targets = [_target(body, meshes, t, start, colours) for t in range(len(meshes))]
    chained = alignment.chain(body, meshes, targets, start)
    shares = np.array([frame.uncovered for frame in chained])
    again = recovery(body, shares, lambda t: chained[t].pose, targets.__getitem__, start, alignment.FITTING).recovered
    poses = [again.get(t, frame).pose for t, frame in enumerate(chained)]
    limb = cluster = np.full(len(body.node), -1)
    for number, settings in enumerate(PASSES):
        s = loose_limb_ends(body, learned_stiffness(body, poses), limb)
        s = loose_between_clusters(body, s, cluster) if settings.is_loosened else s
        poses = [fit(body, pose, targets[t], settings.fit, s).pose for t, pose in enumerate(poses)]
        if not number:
            cluster = rigid_clusters(body, poses)
            poses, limb = with_roll(body, cluster, poses, targets, start)
    return body, poses, (time.process_time() - begun) / len(meshes)


def _target(body: DeformationGraph, meshes: list[Cleaned], t: int, start: int, colours: list[Floats] | None) -> Target:
    colour = None if colours is None else FrameColour(colours[t], colours[start])
    return Target.of(meshes[t].V, meshes[t].F, body.size, colour=colour)


def scores(body: DeformationGraph, poses: list[Pose], observed: Body, skinned: Body, start: int) -> tuple[Floats, Floats]:
    """(frame, vertex) sliding, % of the height · (limb and frame,) roll that is wrong, degrees."""
    skin, F = np.stack([skinned.frame(t)[0] for t in range(len(poses))]), skinned.skin.F
    on = projected(body.V, skin[start], F)
    true = np.einsum("vk,tvkx->tvx", on.share, skin[:, F[on.face]])
    estimated = np.stack([shape(body, pose)[0] for pose in poses])
    N = np.stack([vertex_normals(x, body.F) for x in true])
    off = estimated - true
    off -= np.einsum("tvx,tvx->tv", off, N)[..., None] * N
    part, rolls = observed.parts(start, body.V), []
    for number in np.unique(part):
        member = part == number
        if member.sum() < 25:
            continue
        P = true[start][member]
        axis = np.linalg.svd(P - P.mean(axis=0), full_matrices=False)[2][0]
        for t in [t for t in range(len(poses)) if t != start]:
            turn = _turn(P, true[t][member]).T @ _turn(P, estimated[t][member])
            rolls.append(abs(np.degrees(Rotation.from_matrix(turn).as_rotvec() @ axis)))
    return np.linalg.norm(off, axis=2) / observed.figure.height * 100, np.array(rolls)


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
    for name in args.names:
        for seed in args.seeds:
            meshes, colours, observed, skinned = sequence(name, args, seed)
            start = args.frames // 2
            for used in (False, True):
                body, poses, seconds = aligned(meshes, start, colours if used else None)
                slide, roll = scores(body, poses, observed, skinned, start)
                line = f"{name:13s} {seed:4d} {'used' if used else '–':7s} {slide.mean():14.3f} {np.quantile(slide, 0.95):6.2f}"
                line += f" {roll.mean():12.1f} {(roll > 10).mean() * 100:7.1f} {(roll > 20).mean() * 100:7.1f} {seconds:7.2f}"
                print(line, flush=True)


if __name__ == "__main__":
    main()
