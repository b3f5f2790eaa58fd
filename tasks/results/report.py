"""One page that shows the result of a run: the moving body, and the curves and tables by which a person judges it."""

from collections.abc import Mapping
from html import escape
from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.frame_confidence import FrameConfidence
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
from kinetree.tasks.results.page.scene import Limits, scene
from kinetree.tasks.results.page.warnings import WarningLimits, counted, skin_distance, warnings
from kinetree.tasks.results.plots.alignment import alignment as alignment_figure
from kinetree.tasks.results.plots.alignment import reference_frame
from kinetree.tasks.results.plots.evaluation import evaluation_figure
from kinetree.tasks.results.plots.macroscopic import correlation as correlation_figure
from kinetree.tasks.results.plots.macroscopic import mu as mu_figure
from kinetree.tasks.results.plots.motion import angles
from kinetree.tasks.results.plots.structure import confidence, tree
from kinetree.tasks.results.plots.structure import skeleton as skeleton_figure
from kinetree.tasks.views.results import evaluation_remarks
from kinetree.tasks.views.topology import UNSURE

VARIATION = "length varies by, %"


@task()
def report(
    skeleton: Skeleton,
    structure_figures: StructureFigures,
    sequence: Sequence,
    connectivity: Connectivity,
    correlation: Correlation,
    intervals: Intervals,
    leaves: Leaves,
    evaluation: Evaluation,
    up_direction: UpDirection,
    frame_confidence: FrameConfidence,
    alignment: Mapping[int, Alignment],
    projection: Mapping[int, Projection],
    mesh: Mapping[int, Mesh],
    geodesics: Mapping[int, Geodesics],
    params: ReportParams,
) -> Report:
    """Draws the result of the run on one page that needs no network (ours)."""
    of_sequence = {"skeleton": skeleton, "correlation": correlation, "intervals": intervals, "leaves": leaves}
    by_frame = {"alignment": alignment, "mesh": mesh, "geodesics": geodesics}

    def fetch(name: str, frame: int | None = None) -> Any:
        return of_sequence[name] if frame is None else by_frame[name][frame]

    limits = Limits(params.frames, params.vertices, params.input_vertices)
    up = up_direction.axis
    frames = [skeleton.frames[t] for t in evenly_spread(len(skeleton.frames), params.views)]
    has_truth = evaluation.summary is not None
    page = Page(
        title=params.title or f"kinetree: {counted(skeleton.kinds.count('joint'), 'joint')} in {len(skeleton.frames)} frames",
        facts=_facts(skeleton, sequence, intervals, up_direction, alignment),
        warnings=warnings(skeleton, sequence, intervals, leaves, frame_confidence, alignment, mesh),
        scene=scene(skeleton, alignment, projection, mesh, leaves, intervals, limits, up),
        sections=[
            Section("structure", "Joints and parts", _structure(fetch, frames, up, skeleton, intervals, structure_figures)),
            *([Section("truth", "Comparison with the truth", _comparison(evaluation))] if has_truth else []),
            *sections(structure_figures),
            Section("intervals", "Topology over time", _topology(fetch, frames, up)),
            Section("alignment", "Alignment", _alignment(fetch, frames, up, connectivity)),
        ],
    )
    return Report(text=np.frombuffer(document(page).encode(), dtype=np.uint8))


def _structure(
    fetch: Any, frames: list[int], up: int, skeleton: Skeleton, intervals: Intervals, figures: StructureFigures
) -> str:
    """Pictures of the skeleton and a table of its joints."""
    unit = skeleton.unit or "the unit of the input"
    pictures = (
        picture(skeleton_figure(fetch, frames, up), "Parts and skeleton; white where the surface is not rigid.", vector=False)
        + picture(tree(fetch, frames, up), "The tree of joints with bone lengths and the range of every joint's angle.")
        + picture(
            confidence(fetch, frames, up),
            "Confidence of every joint over time, and the drift of every joint: the distance between its two parts.",
        )
        + picture(
            angles(fetch, frames, up), "Angle of every joint against the reference pose; bold where confidence is below 0.5."
        )
    )
    note = f"<p>Lengths in {escape(unit)}. Intervals are listed where a joint's mean confidence is at least 0.5.</p>"
    return pictures + note + table(*_joint_table(skeleton, intervals, figures))


def _joint_table(skeleton: Skeleton, intervals: Intervals, figures: StructureFigures) -> tuple[list[str], list[list[object]]]:
    """Names of the columns and a row for every joint, without the column of lengths where none is known."""
    parents = np.array(skeleton.parents)
    columns: dict[str, list[object]] = {
        "joint": list(skeleton.names),
        "kind": list(skeleton.kinds),
        "parent": [skeleton.names[p] if p >= 0 else "–" for p in parents],
        "bone length": skeleton.lengths.tolist(),
        VARIATION: [f"{v:.2g}" if np.isfinite(v) else "–" for v in np.where(parents < 0, np.nan, figures.length_variation)],
        "range, °": skeleton.degrees.tolist(),
        "drift": skeleton.drift.tolist(),
        "frames": skeleton.support.tolist(),
        "intervals": [_confident_intervals(skeleton, intervals, j) for j in range(len(parents))],
        "confidence": skeleton.confidence.mean(axis=0).tolist(),
    }
    if not np.isfinite(figures.length_variation).any():
        del columns[VARIATION]
    return list(columns), [list(row) for row in zip(*columns.values(), strict=True)]


def _confident_intervals(skeleton: Skeleton, intervals: Intervals, j: int) -> str:
    """The intervals in which the mean confidence of a joint is not low."""
    spans = zip(intervals.begin, intervals.end, strict=True)
    means = [float(skeleton.confidence[int(a) : int(b) + 1, j].mean()) for a, b in spans]
    confident = [str(number) for number, mean in enumerate(means) if mean >= WarningLimits().confidence]
    return "all" if len(confident) == len(means) else ", ".join(confident) or "none"


def _comparison(evaluation: Evaluation) -> str:
    """A picture of the errors and a table of the scored joints."""
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
    remarks = "".join(f"<p>{escape(text)}</p>" for text in evaluation_remarks(evaluation))
    head = ("true joint", "range, °", "found as", evaluation.unit or "length", "% of the height")
    caption = "Error of every joint over time with its mean and deviation (2014, Fig. 16); below, the measures of 2009."
    return remarks + picture(evaluation_figure(evaluation), caption) + table(head, rows)


def _topology(fetch: Any, frames: list[int], up: int) -> str:
    """Pictures of the correlation, the intervals and μ."""
    return picture(
        correlation_figure(fetch, frames, up),
        "Correlation C(t) (Eq. 2) with cuts and intervals; below, every cue relative to its threshold.",
    ) + picture(
        mu_figure(fetch, frames, up), "μ on the surface, from low (dark) to high (bright), with the leaves.", vector=False
    )


def _alignment(fetch: Any, frames: list[int], up: int, connectivity: Connectivity) -> str:
    """A picture of the residuals, where anything was aligned."""
    if connectivity.fixed:
        return "<p>All frames have the same faces, so nothing had to be aligned.</p>"
    caption = "Distance of the aligned mesh from every frame, over time and on the surface."
    return picture(alignment_figure(fetch, frames, up), caption, vector=False)


def _facts(
    skeleton: Skeleton, sequence: Sequence, intervals: Intervals, up_direction: UpDirection, alignments: Mapping[int, Alignment]
) -> list[tuple[str, str]]:
    """The numbers at the head of the page, with their names."""
    distance = f"{100 * skin_distance(skeleton, alignments):.2g} % of the body's diagonal"
    return [
        ("frames", str(len(skeleton.frames))),
        ("joints", str(skeleton.kinds.count("joint"))),
        ("leaves", str(skeleton.kinds.count("leaf"))),
        ("intervals", str(len(intervals.begin))),
        ("reference frame", str(reference_frame(skeleton, alignments))),
        ("skin to aligned mesh", distance),
        ("unit", sequence.unit or "not known"),
        ("frames a second", f"{sequence.fps:g}" if sequence.fps else "not known"),
        ("up", up_direction.up + (", not certain" if up_direction.confidence < UNSURE else "")),
    ]
