"""One page that shows what a run found: the body playing, the curves and the tables a person needs to trust it."""

from collections.abc import Mapping
from html import escape
from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.schemas.results.report import Report, ReportParams
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.correlation import Correlation
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.scene import evenly_spread
from kinetree.tasks.results.page.chapters import sections
from kinetree.tasks.results.page.document import Page, Section, document, picture, table
from kinetree.tasks.results.page.heed import counted, heeded, off
from kinetree.tasks.results.page.scene import Limits, scene
from kinetree.tasks.results.plots.alignment import alignment as alignment_figure
from kinetree.tasks.results.plots.alignment import at_rest
from kinetree.tasks.results.plots.evaluation import drawn as errors_figure
from kinetree.tasks.results.plots.macroscopic import correlation as correlation_figure
from kinetree.tasks.results.plots.macroscopic import mu as mu_figure
from kinetree.tasks.results.plots.motion import angles
from kinetree.tasks.results.plots.structure import confidence, tree
from kinetree.tasks.results.plots.structure import skeleton as skeleton_figure
from kinetree.tasks.views.results import evaluation_remarks
from kinetree.tasks.views.topology import UNSURE


@task()
def report(
    skeleton: Skeleton,
    evidence: StructureFigures,
    sequence: Sequence,
    connectivity: Connectivity,
    correlation: Correlation,
    intervals: Intervals,
    leaves: Leaves,
    evaluation: Evaluation,
    up_direction: UpDirection,
    alignment: Mapping[int, Alignment],
    projection: Mapping[int, Projection],
    mesh: Mapping[int, Mesh],
    geodesics: Mapping[int, Geodesics],
    params: ReportParams,
) -> Report:
    """Draws and tells the run on one page that needs no network (ours)."""
    once = {"skeleton": skeleton, "correlation": correlation, "intervals": intervals, "leaves": leaves}
    framed = {"alignment": alignment, "mesh": mesh, "geodesics": geodesics}

    def fetch(name: str, frame: int | None = None) -> Any:
        return once[name] if frame is None else framed[name][frame]

    limits = Limits(params.frames, params.vertices, params.input_vertices)
    up = up_direction.axis
    frames = [skeleton.frames[t] for t in evenly_spread(len(skeleton.frames), params.views)]
    page = Page(
        title=params.title or f"kinetree: {counted(skeleton.kinds.count('joint'), 'joint')} in {len(skeleton.frames)} frames",
        facts=_facts(skeleton, sequence, intervals, up_direction, alignment),
        warnings=heeded(skeleton, intervals, leaves, alignment, mesh),
        scene=scene(skeleton, alignment, projection, mesh, leaves, intervals, limits, up),
        sections=[
            Section("structure", "Joints and parts", _structure(fetch, frames, up, skeleton, intervals, evidence)),
            *([Section("truth", "Against the truth", _judged(evaluation))] if evaluation.summary is not None else []),
            *sections(evidence),
            Section("intervals", "Topology over time", _macroscopic(fetch, frames, up)),
            Section("alignment", "Alignment", _aligned(fetch, frames, up, connectivity)),
        ],
    )
    return Report(text=np.frombuffer(document(page).encode(), dtype=np.uint8))


def _structure(
    fetch: Any, frames: list[int], up: int, skeleton: Skeleton, intervals: Intervals, evidence: StructureFigures
) -> str:
    unit = skeleton.unit or "unit of the input"
    pictures = (
        picture(skeleton_figure(fetch, frames, up), "Parts and skeleton; white where the surface is not rigid.", vector=False)
        + picture(tree(fetch, frames, up), "The tree of joints with lengths of bones and ranges of turning.")
        + picture(confidence(fetch, frames, up), "Confidence of every joint over time, and by what its two parts disagree.")
        + picture(
            angles(fetch, frames, up), "Turning of every joint since the reference pose; bold where confidence is below a half."
        )
    )
    told = f"<p>Lengths in {escape(unit)}. Intervals are those in which a joint's confidence is at least a half.</p>"
    return pictures + told + table(*_joints(skeleton, intervals, evidence))


def _joints(skeleton: Skeleton, intervals: Intervals, evidence: StructureFigures) -> tuple[list[str], list[list[object]]]:
    """A row for every joint; what no joint has is no column."""
    parents = np.array(skeleton.parents)
    columns: dict[str, list[object]] = {
        "joint": list(skeleton.names),
        "kind": list(skeleton.kinds),
        "parent": [skeleton.names[p] if p >= 0 else "–" for p in parents],
        "bone": skeleton.lengths.tolist(),
        "varies by, %": [f"{v:.2g}" if np.isfinite(v) else "–" for v in np.where(parents < 0, np.nan, evidence.varies)],
        "turns, °": skeleton.degrees.tolist(),
        "parts disagree by": skeleton.drift.tolist(),
        "frames": skeleton.support.tolist(),
        "intervals": [_supporting(skeleton, intervals, j) for j in range(len(parents))],
        "confidence": skeleton.confidence.mean(axis=0).tolist(),
    }
    if not np.isfinite(evidence.varies).any():
        del columns["varies by, %"]
    return list(columns), [list(row) for row in zip(*columns.values(), strict=True)]


def _supporting(skeleton: Skeleton, intervals: Intervals, j: int) -> str:
    """The intervals in which a joint is rather to be believed than not."""
    spans = zip(intervals.begin, intervals.end, strict=True)
    means = [float(skeleton.confidence[int(a) : int(b) + 1, j].mean()) for a, b in spans]
    held = [str(number) for number, mean in enumerate(means) if mean >= 0.5]
    return "all" if len(held) == len(means) else ", ".join(held) or "none"


def _judged(evaluation: Evaluation) -> str:
    rows = [
        (
            joint.name,
            "–" if joint.turns is None else f"{joint.turns:.0f}",
            joint.found or "missing",
            "–" if joint.mean is None else f"{joint.mean:.4g} ± {joint.deviation:.2g}",
            "–" if joint.percent is None else f"{joint.percent:.2f}",
        )
        for joint in evaluation.joints
        if joint.scored
    ]
    told = "".join(f"<p>{escape(text)}</p>" for text in evaluation_remarks(evaluation))
    head = ("true joint", "turns, °", "found as", evaluation.unit or "length", "% of the height")
    caption = "Error of every joint over time, mean and deviation beside it (2014, Fig. 16); below, the measures of 2009."
    return told + picture(errors_figure(evaluation), caption) + table(head, rows)


def _macroscopic(fetch: Any, frames: list[int], up: int) -> str:
    return picture(
        correlation_figure(fetch, frames, up),
        "C(t) of Eq. 2 with the cuts and the intervals; below, how near every cue came to its threshold.",
    ) + picture(mu_figure(fetch, frames, up), "μ on the surface, from low (dark) to high, with the leaves.", vector=False)


def _aligned(fetch: Any, frames: list[int], up: int, connectivity: Connectivity) -> str:
    if connectivity.fixed:
        return "<p>Every frame has the same faces: a vertex is where it is, and there is nothing to align.</p>"
    caption = "Distance of the aligned mesh to every frame, over time and on the surface."
    return picture(alignment_figure(fetch, frames, up), caption, vector=False)


def _facts(
    skeleton: Skeleton, sequence: Sequence, intervals: Intervals, up_direction: UpDirection, aligned: Mapping[int, Alignment]
) -> list[tuple[str, str]]:
    return [
        ("frames", str(len(skeleton.frames))),
        ("joints", str(skeleton.kinds.count("joint"))),
        ("ends of bones", str(skeleton.kinds.count("leaf"))),
        ("intervals", str(len(intervals.begin))),
        ("reference frame", str(at_rest(skeleton, aligned))),
        ("skin off the aligned meshes by", f"{100 * off(skeleton, aligned):.2g} % of the body's diagonal"),
        ("unit", sequence.unit or "not known"),
        ("frames a second", f"{sequence.fps:g}" if sequence.fps else "not known"),
        ("up", up_direction.up + (", a guess" if up_direction.confidence < UNSURE else "")),
    ]
