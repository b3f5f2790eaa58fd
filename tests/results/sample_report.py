"""A page of a small body, from artifacts that are known to fit together."""

from typing import Any

import numpy as np
import numpy.typing as npt
from results.plain_names import plain
from results.rigged_bodies import bars_of, skinned, spider
from results.sample_derivation import parts_of, reference_of, tree_of

from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.appearance import Appearance
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.coarse_mesh import CoarseMesh, CoarseMeshParams
from kinetree.schemas.results.evaluation import Evaluation, JointScore, Summary
from kinetree.schemas.results.excerpt import ExcerptParams
from kinetree.schemas.results.played_body import PlayedBodyParams
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.correlation import Correlation
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.scene import evenly_spread
from kinetree.tasks.results.alignment_figures import alignment_figures
from kinetree.tasks.results.coarse_mesh import coarse_mesh
from kinetree.tasks.results.cut_figures import cut_figures
from kinetree.tasks.results.derivation_figures import derivation_figures
from kinetree.tasks.results.evaluation_figures import evaluation_figures
from kinetree.tasks.results.excerpt import excerpt
from kinetree.tasks.results.motion_figures import motion_figures
from kinetree.tasks.results.named_figures import named_figures
from kinetree.tasks.results.page.coarse import coarse_meshes
from kinetree.tasks.results.page.document import Page, Section, document, table
from kinetree.tasks.results.page.scene import Limits, Scene, scene
from kinetree.tasks.results.page.trust import Trust, with_trust
from kinetree.tasks.results.played_body import played_body
from kinetree.tasks.results.report import report
from kinetree.tasks.results.skeleton_figures import skeleton_figures
from kinetree.tasks.results.structure_figures import structure_figures
from kinetree.tasks.results.surface_error import surface_error
from kinetree.tasks.results.topology_figures import topology_figures
from kinetree.tasks.results.tree_figures import tree_figures
from kinetree.tasks.results.verdict import verdict

UP = UpDirection(up="y", confidence=1.0)


def trusted(
    assumed: tuple[tuple[str, int, tuple[float, float, float]], ...] = (),
    colours: npt.NDArray[np.uint8] | None = None,
    bounds: bool = True,
) -> Scene:
    """The spider playing, with errors that grow along the body and a confidence that falls from joint to joint.

    bounds : whether the errors of joints have bounds: 1, in the first frame 1.5
    """
    joints, vertices = len(spider().names), len(spider().vertices)
    body = spider(confidence=np.tile(np.linspace(0.9, 0.1, joints), (12, 1)))
    error = {frame: np.linspace(0, 1, vertices) for frame in body.frames}
    labels = ("trunk", "left shoulder", *body.names[2:])
    known = np.where(np.array(body.kinds) == "joint", np.where(np.arange(12) == 0, 1.5, 1.0)[:, None], np.nan)
    trust = Trust(labels, error, 1.0, 0.03, np.zeros((12, joints), np.int64), known if bounds else None)
    return with_trust(playing(body, assumed=assumed, colours=colours), body, trust)


def playing(
    skeleton: Skeleton | None = None,
    limits: Limits | None = None,
    anew: bool = False,
    assumed: tuple[tuple[str, int, tuple[float, float, float]], ...] = (),
    colours: npt.NDArray[np.uint8] | None = None,
) -> Scene:
    """The spider playing."""
    arguments, chosen = artifacts(skeleton, anew=anew), limits or Limits()
    body = arguments["skeleton"]
    shown = {body.frames[t]: arguments["mesh"][body.frames[t]] for t in evenly_spread(len(body.frames), chosen.frames)}
    inputs = coarse_meshes(shown, arguments["projection"], chosen.input_vertices)
    leaves, intervals = arguments["leaves"], arguments["intervals"]
    return scene(body, arguments["alignment"], inputs, leaves, intervals, chosen, assumed=assumed, colours=colours)


def artifacts(skeleton: Skeleton | None = None, anew: bool = False) -> dict[str, Any]:
    """All that a report tells of: every frame's own mesh is the aligned mesh in another order of vertices.

    anew : another order in every frame, not one for all
    """
    skeleton = skeleton or spider()
    frames, x = skeleton.frames, skinned(skeleton)
    count, steps = len(skeleton.vertices), len(skeleton.frames) - 1
    orders = [np.random.default_rng(t if anew else 0).permutation(count) for t in range(len(frames))]
    zero, one = np.zeros(count), np.ones(count)
    return {
        "skeleton": skeleton,
        "joint_names": plain(skeleton),
        "assumed_joints": AssumedJoints(),
        "structure_figures": derived(skeleton),
        "up_direction": UP,
        "connectivity": Connectivity(fixed=not anew, first_change=None, vertices=count, faces=len(skeleton.faces)),
        "sequence": Sequence(frames=frames, fps=skeleton.fps, unit=skeleton.unit),
        "correlation": Correlation(histograms=np.full((len(frames), 4), 0.25), correlation=np.linspace(0.9, 1.0, steps)),
        "intervals": halves(frames),
        "leaves": followed(skeleton),
        "evaluation": unjudged(skeleton),
        "frame_confidence": confident(frames),
        "alignment": {
            f: Alignment(vertices=x[t], residual=zero, stretch=one, confidence=one, uncovered=0.0) for t, f in enumerate(frames)
        },
        "projection": {f: _projected(skeleton, order) for f, order in zip(frames, orders, strict=True)},
        "mesh": {
            f: Mesh(vertices=x[t][order], faces=np.argsort(order).astype(np.int32)[skeleton.faces],
                    vertex_of_input=np.arange(count, dtype=np.int32), cleaning=Cleaning())
            for t, (f, order) in enumerate(zip(frames, orders, strict=True))
        },
        "geodesics": {
            f: Geodesics(mu=np.linalg.norm(x[t][order], axis=1), area=one, bases=np.zeros(1, np.int32), share=1.0)
            for t, (f, order) in enumerate(zip(frames, orders, strict=True))
        },
    }  # fmt: skip


def derived(skeleton: Skeleton) -> StructureFigures:
    """How its joints were found."""
    sequence = Sequence(frames=skeleton.frames, fps=skeleton.fps, unit=skeleton.unit)
    parts, tree = parts_of(skeleton), tree_of(skeleton)
    named = named_figures(parts, tree, plain(skeleton), sequence, UP)
    cut = cut_figures(reference_of(skeleton), parts, UP)
    return structure_figures(tree, cut, derivation_figures(tree, sequence, UP), named)


def page_artifacts(params: ExcerptParams, **changes: Any) -> dict[str, Any]:
    """What the task `report` reads, made of `artifacts` with changes by the tasks before it."""
    all_of_it = {**artifacts(changes.get("skeleton")), **changes}

    def some(*names: str) -> dict[str, Any]:
        return {name: all_of_it[name] for name in names}

    all_of_it["excerpt"] = excerpt(**some("sequence", "mesh"), params=params)
    coarse: dict[int, CoarseMesh] = {}
    for frame in all_of_it["excerpt"].frames:
        before = coarse.get(all_of_it["excerpt"].previous(frame))
        mesh, projection = all_of_it["mesh"][frame], all_of_it["projection"][frame]
        coarse[frame] = coarse_mesh(mesh=mesh, projection=projection, previous=before, params=CoarseMeshParams())
    all_of_it["coarse_mesh"] = tuple(coarse.values())
    topology = some("excerpt", "sequence", "correlation", "intervals", "leaves", "up_direction", "mesh", "geodesics")
    aligned = some("skeleton", "excerpt", "connectivity", "up_direction", "alignment")
    all_of_it["topology_figures"] = topology_figures(**topology)
    all_of_it["alignment_figures"] = alignment_figures(**aligned)
    all_of_it["surface_error"] = {
        frame: surface_error(**some("skeleton"), mesh=mesh, index=(frame,)) for frame, mesh in all_of_it["mesh"].items()
    }
    all_of_it.setdefault("error_bars", bars_of(all_of_it["skeleton"]))
    all_of_it["verdict"] = verdict(**some("skeleton", "joint_names", "frame_confidence", "surface_error", "error_bars"))
    all_of_it["skeleton_figures"] = skeleton_figures(**some("skeleton", "excerpt", "up_direction"))
    all_of_it["appearance"] = changes.get("appearance", Appearance.none())
    all_of_it["tree_figures"] = tree_figures(**some("skeleton", "joint_names"))
    all_of_it["motion_figures"] = motion_figures(**some("skeleton", "joint_names"))
    all_of_it["evaluation_figures"] = evaluation_figures(**some("evaluation", "sequence"))
    played = {argument.name: all_of_it[argument.name] for argument in played_body.arguments}
    all_of_it["played_body"] = played_body(**played, params=PlayedBodyParams())
    return {argument.name: all_of_it[argument.name] for argument in report.arguments}


def _projected(skeleton: Skeleton, order: npt.NDArray[np.int64]) -> Projection:
    """Every vertex as the corner of a face that it is."""
    face = np.array([np.flatnonzero((skeleton.faces == v).any(axis=1))[0] for v in order], np.int32)
    share = (skeleton.faces[face] == order[:, None]).astype(np.float64)
    return Projection(face=face, share=share, distance=np.zeros(len(order)))


def unjudged(skeleton: Skeleton) -> Evaluation:
    """No truth."""
    none = np.zeros(len(skeleton.frames))
    return Evaluation(
        truth="", frames=skeleton.frames, unit=skeleton.unit, height=0.0, joints=(), spurious=(), true_frames=0,
        summary=None, error=np.zeros((len(none), 0)), detection=none, distance=none,
    )  # fmt: skip


def judged(skeleton: Skeleton) -> Evaluation:
    """One joint found, one not."""
    steps = len(skeleton.frames)
    off = np.stack([np.linspace(0.1, 0.3, steps), np.full(steps, np.nan)], axis=1)
    rows = (
        JointScore(name="shoulder", scored=True, turns=50.0, found="arm", mean=0.2, deviation=0.06, worst=0.3, percent=1.25),
        JointScore(name="elbow <i>", scored=True, turns=40.0, nearest=9.0),
    )
    return Evaluation(
        truth="truth.json", frames=skeleton.frames, unit=skeleton.unit, height=16.0, joints=rows, spurious=("knee",),
        true_frames=steps, summary=Summary(scored=2, found=1, missing=1, spurious=1, percent=1.25), error=off,
        detection=np.full(steps, 0.5), distance=np.full(steps, 0.0125),
    )  # fmt: skip


def confident(
    frames: tuple[int, ...], failed: tuple[int, ...] = (), unreliable: dict[int, float] | None = None
) -> FrameConfidence:
    """All frames are inliers but the failed ones; some have a share of the body in doubt."""
    none = np.zeros(len(frames))
    return FrameConfidence(
        frames=frames, residual=none, uncovered=none, unreliable=np.array([(unreliable or {}).get(f, 0.0) for f in frames]),
        inlier=np.array([f not in failed for f in frames]),
    )  # fmt: skip


def followed(skeleton: Skeleton) -> Leaves:
    """Every end of a bone as a leaf; the first is not known in the second half."""
    tips = [j for j, kind in enumerate(skeleton.kinds) if kind == "leaf"]
    positions = skeleton.positions[:, tips].transpose(1, 0, 2).copy()
    positions[0, len(skeleton.frames) // 2 :] = np.nan
    none = np.zeros(0, np.int32)
    rows = np.zeros(positions.shape[:2], np.int32)
    counts = np.ones((2, len(tips)), np.bool_)
    return Leaves(
        frames=skeleton.frames, rows=rows, positions=positions, kept=counts, lost=none, lost_begin=none, lost_end=none
    )


def halves(frames: tuple[int, ...]) -> Intervals:
    """Two intervals."""
    cut = len(frames) // 2
    return Intervals(
        frames=frames, begin=np.array([0, cut]), end=np.array([cut - 1, len(frames) - 1]), z=np.zeros(len(frames) - 1),
        cues=(("leaves",),), strengths=np.zeros((1, len(frames) - 1)), cue_names=("correlation",), threshold=2.0,
    )  # fmt: skip


def page(title: str = "a walk", **more: object) -> str:
    """The whole page, what ran not yet told."""
    body = table(("joint", "turns"), [("trunk", 0.0), ("arm", 50.5)], joints=True)
    arguments = {
        "level": "good",
        "headline": "good",
        "facts": [("frames", "12")],
        "scene": trusted(),
        "sections": [Section("s", "Joints", body)],
    }
    return document(Page(title=title, **{**arguments, **more}))  # type: ignore[arg-type]
