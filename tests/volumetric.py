"""A pipe of three arms that swing, through all tasks of the 2009 paper, each called as the plain function it is.

The body is known: arms of length 24 that turn at 12 from the middle, which is the root. Every frame is surfaced alike, which
no task of the shelf knows.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from articulated import Known, swings, three_arms

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervals, CoherentIntervalsParams
from kinetree.schemas.paper_2009.contact_kinds import ContactKinds
from kinetree.schemas.paper_2009.graph_deformation import GraphDeformation, GraphDeformationParams
from kinetree.schemas.paper_2009.graph_motion import GraphMotion, GraphMotionParams
from kinetree.schemas.paper_2009.graph_skeleton import GraphSkeletonParams
from kinetree.schemas.paper_2009.graph_tracking import GraphTrackingParams
from kinetree.schemas.paper_2009.initial_frames import InitialFrames, InitialFramesParams
from kinetree.schemas.paper_2009.initial_model import InitialModel, InitialModelParams
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.schemas.paper_2009.node_clusters import NodeClusters, NodeClustersParams
from kinetree.schemas.paper_2009.perg import Perg, PergParams
from kinetree.schemas.paper_2009.reeb_graph import ReebGraph, ReebGraphParams
from kinetree.schemas.paper_2009.similarity import Similarity, SimilarityParams
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.deformation_graph import DeformationGraph, DeformationGraphParams
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.refit import Refit
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.tracking import Tracking
from kinetree.schemas.registration.tracking_order import TrackingOrder
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.topology.extrema import Extrema, ExtremaParams
from kinetree.schemas.topology.geodesics import GeodesicsParams
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves, LeavesParams
from kinetree.tasks.paper_2009.coherent_intervals import coherent_intervals
from kinetree.tasks.paper_2009.contact_kinds import contact_kinds
from kinetree.tasks.paper_2009.graph_alignment import graph_alignment
from kinetree.tasks.paper_2009.graph_deformation import graph_deformation
from kinetree.tasks.paper_2009.graph_motion import graph_motion
from kinetree.tasks.paper_2009.graph_reference import graph_reference
from kinetree.tasks.paper_2009.graph_skeleton import graph_skeleton
from kinetree.tasks.paper_2009.graph_tracking import graph_tracking
from kinetree.tasks.paper_2009.initial_frames import initial_frames
from kinetree.tasks.paper_2009.initial_model import initial_model
from kinetree.tasks.paper_2009.integrated_structure import integrated_structure
from kinetree.tasks.paper_2009.node_clusters import node_clusters
from kinetree.tasks.paper_2009.perg import perg
from kinetree.tasks.paper_2009.reeb_graph import reeb_graph
from kinetree.tasks.paper_2009.similarity import similarity
from kinetree.tasks.registration.alignment import alignment
from kinetree.tasks.registration.deformation_graph import deformation_graph
from kinetree.tasks.registration.first_fit import first_fit
from kinetree.tasks.registration.recovery import recovery
from kinetree.tasks.registration.take_entries import take_entries
from kinetree.tasks.registration.tracking_order import tracking_order
from kinetree.tasks.topology.extrema import extrema
from kinetree.tasks.topology.geodesics import geodesics
from kinetree.tasks.topology.leaves import leaves

FRAMES = 10
INTERVALS = 2
"""In the paper's letter the frame in the middle counts as incoherent, so that there are two intervals."""


@dataclass(frozen=True)
class Volumetric:
    """The artifact of every task, by frame or by structure where there are several."""

    body: Known
    mesh: dict[int, Mesh]
    extrema: dict[int, Extrema]
    leaves: Leaves
    reeb_graph: dict[int, ReebGraph]
    perg: dict[int, Perg]
    similarity: Similarity
    coherent_intervals: CoherentIntervals
    initial_frames: InitialFrames
    initial_model: dict[int, InitialModel]
    graph_deformation: dict[int, GraphDeformation]
    node_clusters: dict[int, NodeClusters]
    integrated_structure: IntegratedStructure
    graph_motion: dict[int, GraphMotion]
    graph_alignment: dict[int, Alignment]
    graph_reference: Reference
    deformation_graph: DeformationGraph
    graph_tracking: dict[int, Tracking]
    alignment: dict[int, Alignment]
    contact_kinds: ContactKinds
    tree: KinematicTree


@cache
def volumetric(*, letter: bool = False) -> Volumetric:
    """All artifacts of the default, or of the paper's letter."""
    body = three_arms(swings(FRAMES, 4, degrees=25.0))
    mesh = {t: meshed(body, t) for t in range(FRAMES)}
    mu = {t: geodesics(m, GeodesicsParams(bases=80)) for t, m in mesh.items()}
    ends = {t: extrema(m, mu[t], ExtremaParams()) for t, m in mesh.items()}
    tracks = leaves(ends, whole(), LeavesParams())
    graphs = {t: reeb_graph(m, mu[t], ReebGraphParams(levels=5)) for t, m in mesh.items()}
    inner = {t: perg(m, graphs[t], ends[t], PergParams()) for t, m in mesh.items()}
    alike = similarity(graphs, SimilarityParams())
    runs = coherent_intervals(inner, Sequence(frames=tuple(mesh), fps=25.0, unit="mm"), CoherentIntervalsParams())
    if letter:
        runs = divided(runs)
    start = initial_frames(
        runs, alike, InitialFramesParams(scope="interval", start="correlation") if letter else InitialFramesParams()
    )
    numbers = start.members("structure", ())
    models = {s: initial_model((s,), start, inner, mesh, ends, tracks, InitialModelParams()) for s in numbers}
    forces = literal() if letter else {}
    moved = deformations(start, models, inner, mesh, tracks, GraphDeformationParams(**forces))
    rule = NodeClustersParams(rule="correlation", relative=False, one_too_few=True) if letter else NodeClustersParams()
    of = {
        s: node_clusters((s,), models[s], {t: moved[t] for t in start.members("structure/frame", (s,))}, rule) for s in numbers
    }
    one = integrated_structure(start, models, of, alike)
    motion = motions(one, start, moved, inner, mesh, tracks, GraphMotionParams(**forces))
    place = GraphSkeletonParams(joints="edges" if letter else "centres")
    carried = {t: graph_alignment(m) for t, m in motion.items()}
    reference = graph_reference(one, runs)
    entries = take_entries(ends, reference)
    order = tracking_order(reference, entries, Sequence(frames=tuple(mesh), fps=25.0, unit="mm"), ends, tracks)
    nodes, tracked = followed(reference, order, one, motion, mesh)
    aligned = carried if letter else aligned_by(reference, entries, nodes, tracked, mesh, ends)
    tree = graph_skeleton(one, motion, aligned, mesh, place)
    touching = contact_kinds(one, motion, runs)
    return Volumetric(
        body, mesh, ends, tracks, graphs, inner, alike, runs, start, models, moved, of, one, motion, carried,
        reference, nodes, tracked, aligned, touching, tree,
    )  # fmt: skip


def followed(
    reference: Reference, order: TrackingOrder, one: IntegratedStructure, motion: dict[int, GraphMotion], mesh: dict[int, Mesh]
) -> tuple[DeformationGraph, dict[int, Tracking]]:
    """The deformation graph of the default, and the surface bent onto every frame, in the order of the traversal."""
    nodes = deformation_graph(reference, DeformationGraphParams(nodes=150))
    done: dict[int, Tracking] = {}
    for frame in sorted(one.frames, key=lambda t: abs(t - one.frame)):
        last = order.previous(frame)
        before = None if last is None else done[last]
        done[frame] = graph_tracking(mesh[frame], nodes, one, motion[frame], before, GraphTrackingParams())
    return nodes, {t: done[t] for t in sorted(done)}


def aligned_by(
    reference: Reference,
    entries: TakeEntries,
    nodes: DeformationGraph,
    tracked: dict[int, Tracking],
    mesh: dict[int, Mesh],
    ends: dict[int, Extrema],
) -> dict[int, Alignment]:
    """The surface as it was tracked, without the passes of the shelf registration."""
    fitted = {t: first_fit(mesh[t], nodes, at) for t, at in tracked.items()}
    usual = recovery(nodes, entries, fitted, mesh, ends)
    poses = {t: Refit(rotation=at.rotation, translation=at.translation) for t, at in tracked.items()}
    return {t: alignment(mesh[t], reference, nodes, usual, (at,)) for t, at in poses.items()}


def meshed(body: Known, t: int) -> Mesh:
    """One frame as the cleaned mesh."""
    area = float(body.area.sum())
    vertex = np.arange(len(body.V))
    return Mesh(vertices=body.x[t], faces=body.F, vertex_of_input=vertex, cleaning=Cleaning(area=area))


def whole() -> Intervals:
    """One interval of all frames."""
    none = np.zeros(FRAMES - 1)
    return Intervals(
        frames=tuple(range(FRAMES)), begin=np.zeros(1, int), end=np.array([FRAMES - 1]), z=none, cues=(),
        strengths=none[None], cue_names=("leaves",), threshold=2.0,
    )  # fmt: skip


def divided(runs: CoherentIntervals) -> CoherentIntervals:
    """The same with the frame in the middle incoherent."""
    middle = FRAMES // 2
    coherent = np.arange(FRAMES) != middle
    begin, end = np.array([0, middle + 1]), np.array([middle - 1, FRAMES - 1])
    return runs.model_copy(update={"coherent": coherent, "begin": begin, "end": end})


def literal() -> dict[str, object]:
    """Forces to the paper's letter, but for the constants that it does not give."""
    return {"stiffness": 0.1, "anchor": 1e-4, "rest_length": False, "centred": False, "branches": False, "surface": False}


def deformations(
    start: InitialFrames, models: dict[int, InitialModel], inner: dict[int, Perg], mesh: dict[int, Mesh], tracks: Leaves,
    params: GraphDeformationParams,
) -> dict[int, GraphDeformation]:  # fmt: skip
    """Every frame of every structure, in the order of the traversal."""
    done: dict[int, GraphDeformation] = {}
    for s, model in models.items():
        waiting = list(start.members("structure/frame", (s,)))
        while waiting:
            frame = next(t for t in waiting if start.previous(t) is None or start.previous(t) in done)
            waiting.remove(frame)
            last = start.previous(frame)
            before = None if last is None else done[last]
            done[frame] = graph_deformation((s, frame), model, inner[frame], mesh[frame], tracks, before, params)
    return done


def motions(
    one: IntegratedStructure, start: InitialFrames, moved: dict[int, GraphDeformation], inner: dict[int, Perg],
    mesh: dict[int, Mesh], tracks: Leaves, params: GraphMotionParams,
) -> dict[int, GraphMotion]:  # fmt: skip
    """The integrated structure in all frames, in the order of the traversal."""
    done: dict[int, GraphMotion] = {}
    waiting = list(one.frames)
    while waiting:
        frame = next(t for t in waiting if one.previous(t) is None or one.previous(t) in done)
        waiting.remove(frame)
        last = one.previous(frame)
        known = (moved[frame],) if frame in moved else ()
        before = None if last is None else done[last]
        done[frame] = graph_motion((frame,), one, known, inner[frame], mesh[frame], tracks, before, params)
    return {t: done[t] for t in sorted(done)}
