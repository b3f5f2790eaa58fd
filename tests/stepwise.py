"""Step II, task after task, called as the plain functions they are, on generated bodies."""

import collections.abc as abc
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.input.synth import SynthParams
from kinetree.schemas.registration.deformation_graph import DeformationGraphParams
from kinetree.schemas.registration.reference import ReferenceParams
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.tracking import TrackingParams
from kinetree.schemas.topology.extrema import Extrema, ExtremaParams
from kinetree.schemas.topology.geodesics import GeodesicsParams
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves, LeavesParams
from kinetree.schemas.topology.mu_histogram import MuHistogramParams
from kinetree.tasks.input.connectivity import connectivity
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.input.mesh import clean
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.registration.alignment import alignment
from kinetree.tasks.registration.deformation_graph import deformation_graph
from kinetree.tasks.registration.first_fit import first_fit
from kinetree.tasks.registration.frame_confidence import frame_confidence
from kinetree.tasks.registration.projection import projection
from kinetree.tasks.registration.recovery import recovery
from kinetree.tasks.registration.reference import reference
from kinetree.tasks.registration.refit import refit
from kinetree.tasks.registration.roll import roll
from kinetree.tasks.registration.roll_candidates import roll_candidates
from kinetree.tasks.registration.stiffness import stiffness
from kinetree.tasks.registration.tracking import tracking
from kinetree.tasks.registration.tracking_order import tracking_order
from kinetree.tasks.topology.extrema import extrema
from kinetree.tasks.topology.geodesics import geodesics
from kinetree.tasks.topology.leaves import leaves
from kinetree.tasks.topology.mu_histogram import mu_histogram


def cleaned(V: np.ndarray, F: np.ndarray) -> Mesh:
    """One frame as the task `mesh` leaves it."""
    result = clean(V, F.astype(np.int32))
    cleaning = Cleaning(area=result.area, euler=result.euler)
    return Mesh(vertices=result.V, faces=result.F, vertex_of_input=result.vertex_map, cleaning=cleaning)


def bodied(**params: Any) -> Body:
    """A generated body; a walking human of five frames, but for what is told."""
    return body(recipe(SynthParams(**{"figure": "human", "frames": 5, "vertices": 1500, **params})))


def generated(**params: Any) -> dict[int, Mesh]:
    """Every frame of it."""
    generator = bodied(**params)
    return {t: cleaned(*generator.frame(t)) for t in range(len(generator.X))}


def along(task: Any, order: Any, frames: abc.Sequence[int], **per_frame: Any) -> dict[int, Any]:
    """A task that reads its own previous artifact, over all frames in the order of its traversal."""
    artifacts: dict[int, Any] = {}

    def at(frame: int) -> Any:
        if frame not in artifacts:
            before = order.previous(frame)
            previous = None if before is None else at(before)
            here = {k: v[frame] if isinstance(v, dict) else v for k, v in per_frame.items()}
            artifacts[frame] = task(**here, previous=previous)
        return artifacts[frame]

    return {frame: at(frame) for frame in frames}


def uncut(count: int) -> Intervals:
    """One interval of so many frames."""
    return Intervals(
        frames=tuple(range(count)), begin=np.array([0]), end=np.array([count - 1]), z=np.zeros(count - 1), cues=(),
        strengths=np.zeros((0, count - 1)), cue_names=(), threshold=2.0,
    )  # fmt: skip


def referred(meshes: dict[int, Mesh]) -> tuple[Any, dict[int, Extrema], Leaves]:
    """The reference of a sequence, the extrema of every frame, and its leaves."""
    mu = {t: geodesics(m, GeodesicsParams(bases=40)) for t, m in meshes.items()}
    tips = {t: extrema(meshes[t], g, ExtremaParams()) for t, g in mu.items()}
    followed = leaves(tips, uncut(len(tips)), LeavesParams())
    chosen = reference(
        mesh=meshes,
        distribution={t: mu_histogram(g, MuHistogramParams()) for t, g in mu.items()},
        tips=tips,
        leaves=followed,
        connectivity=connectivity(meshes),
        params=ReferenceParams(),
    )
    return chosen, tips, followed


def aligned(meshes: dict[int, Mesh], nodes: int = 200) -> SimpleNamespace:
    """Every artifact of Step II, by the name of its task; per frame as a mapping, per pass as a list."""
    steps = SimpleNamespace(mesh=meshes)
    steps.reference, steps.extrema, steps.leaves = referred(meshes)
    graph = steps.deformation_graph = deformation_graph(steps.reference, DeformationGraphParams(nodes=nodes))
    steps.sequence = Sequence(frames=tuple(meshes), fps=None, unit=None)
    steps.take_entries, steps.numbers = (
        TakeEntries(
            frames=(),
            before=(),
            entry=np.zeros(0, np.int32),
            rotation=np.zeros((0, 3, 3)),
            shift=np.zeros((0, 3)),
            distance=np.zeros(0),
        ),
        {t: (t,) for t in meshes},
    )
    steps.tracking_order = tracking_order(steps.reference, steps.take_entries, steps.sequence, steps.extrema, steps.leaves)
    steps.tracking = along(
        tracking,
        steps.tracking_order,
        list(meshes),
        mesh=meshes,
        deformation_graph=graph,
        take_entries=steps.take_entries,
        index=steps.numbers,
        params=TrackingParams(),
        tips=steps.extrema,
    )
    steps.first_fit = {t: first_fit(m, graph, steps.tracking[t]) for t, m in meshes.items()}
    steps.recovery = recovery(graph, steps.take_entries, steps.first_fit, meshes, steps.extrema)
    steps.stiffness, steps.roll_candidates, steps.roll, steps.refit = [], [], [], []
    for number in graph.members("pass", ()):
        one_pass(steps, number)
    final = {t: tuple(refit[t] for refit in steps.refit) for t in meshes}
    steps.alignment = {t: alignment(m, steps.reference, graph, steps.recovery, final[t]) for t, m in meshes.items()}
    steps.projection = {t: projection(m, steps.reference, steps.alignment[t]) for t, m in meshes.items()}
    steps.frame_confidence = frame_confidence(steps.alignment, meshes, steps.sequence)
    return steps


def one_pass(steps: SimpleNamespace, number: int) -> None:
    """Appends what a pass leaves, made from the passes before it."""
    graph, index = steps.deformation_graph, (number,)
    before = steps.refit[-1] if steps.refit else {}
    earlier = (steps.stiffness or [None])[-1], (steps.roll or [None])[-1]
    stiff = stiffness(graph, steps.first_fit, steps.recovery, tuple(before.values()), earlier[0], index)
    is_searched = len(graph.members("pass/search", index)) > 0
    tried = {t: roll_candidates(m, graph, stiff, before.get(t)) for t, m in steps.mesh.items()} if is_searched else {}
    chosen = roll(graph, stiff, steps.recovery, tuple(tried.values()), tuple(before.values()), earlier[1], index)
    steps.stiffness.append(stiff)
    steps.roll_candidates.append(tried)
    steps.roll.append(chosen)
    steps.refit.append({t: refitted(steps, number, t, before.get(t)) for t in steps.mesh})


def refitted(steps: SimpleNamespace, number: int, frame: int, before: Any) -> Any:
    """One frame in one pass, from its pose of the pass before."""
    fits = steps.roll_candidates[number]
    of_pass = steps.stiffness[number], (fits[frame],) if fits else (), steps.roll[number]
    here = steps.mesh[frame], steps.deformation_graph, steps.first_fit[frame], steps.recovery
    return refit(*here, *of_pass, before, (number, frame))


@cache
def walk() -> SimpleNamespace:
    """A walking human, aligned: what most tests look at."""
    return aligned(generated())


def lost(limb: int) -> dict[int, RollCandidates]:
    """Candidates of `walk` as frames would have them if one limb fitted a quarter of a turn further, but in the reference."""
    steps, out = walk(), {}
    for t, tried in steps.roll_candidates[1].items():
        angle = np.tile(2 * np.pi * np.arange(tried.angle.shape[1]) / tried.angle.shape[1], (len(tried.angle), 1))
        misfit = np.full_like(angle, 0.2 + 0.001 * t)
        misfit[:, 0] -= 0.05
        if t != steps.reference.frame:
            misfit[limb, 3] -= 0.15
        out[t] = tried.model_copy(update={"angle": angle, "misfit": misfit})
    return out
