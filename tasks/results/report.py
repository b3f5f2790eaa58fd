"""One page that shows the result of a run: the moving body, and the curves and tables by which a person judges it."""

from collections.abc import Mapping
from html import escape

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.results.alignment_figures import AlignmentFigures
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.schemas.results.evaluation_figures import EvaluationFigures
from kinetree.schemas.results.motion_figures import MotionFigures
from kinetree.schemas.results.played_body import PlayedBody
from kinetree.schemas.results.report import Report, ReportParams
from kinetree.schemas.results.skeleton_figures import SkeletonFigures
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.results.surface_error import SurfaceError
from kinetree.schemas.results.topology_figures import TopologyFigures
from kinetree.schemas.results.tree_figures import TreeFigures
from kinetree.schemas.results.verdict import Verdict
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.verdict import VerdictSettings
from kinetree.tasks.results.formats.assumed import NOTHING_ASSUMED
from kinetree.tasks.results.page.chapters import pictures, sections
from kinetree.tasks.results.page.document import Page, Section, document, table
from kinetree.tasks.results.page.played_scene import played_scene
from kinetree.tasks.results.page.trust import Trust, with_trust
from kinetree.tasks.results.page.warnings import WarningLimits, counted, faults, notes
from kinetree.tasks.views.results import evaluation_remarks
from kinetree.tasks.views.structure import assumed_words, two_digits
from kinetree.tasks.views.topology import UNSURE
from kinetree.tasks.views.verdict import headline

VARIATION = "length varies by, %"
ERROR = "expected error"
OFFSET = "surface offset"
EVIDENCE = "evidence"


@task()
def report(
    skeleton: Skeleton,
    structure_figures: StructureFigures,
    skeleton_figures: SkeletonFigures,
    tree_figures: TreeFigures,
    motion_figures: MotionFigures,
    topology_figures: TopologyFigures,
    alignment_figures: AlignmentFigures,
    sequence: Sequence,
    intervals: Intervals,
    leaves: Leaves,
    evaluation: Evaluation,
    up_direction: UpDirection,
    frame_confidence: FrameConfidence,
    evaluation_figures: EvaluationFigures,
    verdict: Verdict,
    error_bars: ErrorBars,
    played_body: PlayedBody,
    surface_error: Mapping[int, SurfaceError],
    mesh: Mapping[int, Mesh],
    params: ReportParams,
    assumed_joints: AssumedJoints = NOTHING_ASSUMED,
) -> Report:
    """Lays out the result of the run on one page that needs no network (ours)."""
    structure = pictures(skeleton_figures) + pictures(tree_figures) + pictures(motion_figures)
    label, truth = dict(zip(verdict.joints, verdict.labels, strict=True)), []
    if evaluation.summary is not None:
        truth = [Section("truth", "Comparison with the truth", _comparison(evaluation, evaluation_figures, label))]
    aligned = pictures(alignment_figures) or "<p>All frames have the same faces, so nothing had to be aligned.</p>"
    joints = _joints(skeleton, verdict.labels, intervals, structure_figures, assumed_joints, error_bars)
    page = Page(
        title=params.title or f"kinetree: {counted(skeleton.kinds.count('joint'), 'joint')} in {len(skeleton.frames)} frames",
        facts=_facts(skeleton, sequence, intervals, up_direction, alignment_figures),
        level=verdict.level,
        headline=headline(verdict),
        faults=faults(verdict),
        notes=notes(verdict, skeleton, sequence, intervals, leaves, frame_confidence, mesh),
        scene=with_trust(played_scene(played_body), skeleton, _trust(skeleton, surface_error, verdict, error_bars)),
        sections=[
            Section("joints", "Joints", joints),
            Section("structure", "Parts, tree and angles", structure),
            *truth,
            *sections(structure_figures),
            Section("intervals", "Topology over time", pictures(topology_figures), is_detail=True),
            Section("alignment", "Alignment", aligned, is_detail=True),
        ],
    )
    return Report(text=np.frombuffer(document(page).encode(), dtype=np.uint8))


def _trust(skeleton: Skeleton, surface_error: Mapping[int, SurfaceError], verdict: Verdict, bars: ErrorBars) -> Trust:
    """What the player shows of how far the body can be relied on."""
    error = {frame: np.asarray(e.distance) for frame, e in surface_error.items()}
    size, share = float(np.linalg.norm(np.ptp(skeleton.vertices, axis=0))), VerdictSettings().wrong
    bound = np.asarray(bars.in_frame * (bars.bound / bars.expected)) if bars.cuts else None
    return Trust(verdict.labels, error, share * size, share, verdict.state, bound)


def _joints(
    skeleton: Skeleton,
    labels: tuple[str, ...],
    intervals: Intervals,
    figures: StructureFigures,
    assumed: AssumedJoints,
    bars: ErrorBars,
) -> str:
    """A table of the skeleton's joints, and below it those that are assumed."""
    unit = skeleton.unit or "the unit of the input"
    note = f"<p>Lengths in {escape(unit)}. Intervals are listed where a joint's mean confidence is at least 0.5.</p>"
    words = (assumed_words(joint, labels, skeleton.parents) for joint in assumed.joints)
    below = "".join(f'<p class="assumed">{escape(text[0].upper() + text[1:])}.</p>' for text in words)
    return note + table(*_joint_table(skeleton, labels, intervals, figures, bars), joints=True) + below


def _joint_table(
    skeleton: Skeleton, labels: tuple[str, ...], intervals: Intervals, figures: StructureFigures, bars: ErrorBars
) -> tuple[list[str], list[list[object]]]:
    """Names of the columns and a row for every joint, without the column of lengths where none is known."""
    parents = np.array(skeleton.parents)
    columns: dict[str, list[object]] = {
        "joint": list(labels),
        "in the store": list(skeleton.names),
        "kind": list(skeleton.kinds),
        "parent": [labels[p] if p >= 0 else "–" for p in parents],
        "bone length": skeleton.lengths.tolist(),
        VARIATION: [f"{v:.2g}" if np.isfinite(v) else "–" for v in np.where(parents < 0, np.nan, figures.length_variation)],
        "range, °": skeleton.degrees.tolist(),
        EVIDENCE: [known or "–" for known in bars.evidence],
        ERROR: [_error_words(bars, j) for j in range(len(parents))],
        "drift": skeleton.drift.tolist(),
        OFFSET: [two_digits(v) if np.isfinite(v) else "–" for v in bars.surface_offset.tolist()],
        "frames": skeleton.support.tolist(),
        "intervals": [_confident_intervals(skeleton, intervals, j) for j in range(len(parents))],
        "confidence": skeleton.confidence.mean(axis=0).tolist(),
    }
    if not np.isfinite(figures.length_variation).any():
        del columns[VARIATION]
    if not bars.cuts:
        del columns[ERROR]
    if not {"shape", "narrowing", "mirror"} & {*bars.evidence}:
        del columns[EVIDENCE]
    if not np.isfinite(bars.surface_offset).any():
        del columns[OFFSET]
    return list(columns), [list(row) for row in zip(*columns.values(), strict=True)]


def _error_words(bars: ErrorBars, j: int) -> str:
    """The expected error of a joint and its bound."""
    known = bool(bars.cuts) and np.isfinite(bars.expected[j])
    return f"{two_digits(bars.expected[j])} (90 %: {two_digits(bars.bound[j])})" if known else "–"


def _confident_intervals(skeleton: Skeleton, intervals: Intervals, j: int) -> str:
    """The intervals in which the mean confidence of a joint is not low."""
    spans = zip(intervals.begin, intervals.end, strict=True)
    means = [float(skeleton.confidence[int(a) : int(b) + 1, j].mean()) for a, b in spans]
    confident = [str(number) for number, mean in enumerate(means) if mean >= WarningLimits().confidence]
    return "all" if len(confident) == len(means) else ", ".join(confident) or "none"


def _comparison(evaluation: Evaluation, figures: EvaluationFigures, label: Mapping[str, str]) -> str:
    """A picture of the errors and a table of the scored joints."""
    rows = [
        (
            joint.name,
            "–" if joint.turns is None else f"{joint.turns:.0f}",
            "missing" if joint.found is None else label.get(joint.found, joint.found),
            "–" if joint.mean is None else f"{joint.mean:.4g} ± {joint.deviation:.2g}",
            "–" if joint.percent is None else f"{joint.percent:.2f}",
        )
        for joint in evaluation.joints
        if joint.scored
    ]
    remarks = "".join(f"<p>{escape(text)}</p>" for text in evaluation_remarks(evaluation))
    head = ("true joint", "range, °", "found as", evaluation.unit or "length", "% of the height")
    return remarks + pictures(figures) + table(head, rows)


def _facts(
    skeleton: Skeleton, sequence: Sequence, intervals: Intervals, up_direction: UpDirection, figures: AlignmentFigures
) -> list[tuple[str, str]]:
    """The numbers at the head of the page, with their names."""
    distance = f"{100 * figures.skin_distance:.2g} % of the body's diagonal"
    return [
        ("frames", str(len(skeleton.frames))),
        ("joints", str(skeleton.kinds.count("joint"))),
        ("leaves", str(skeleton.kinds.count("leaf"))),
        ("intervals", str(len(intervals.begin))),
        ("reference frame", str(figures.reference)),
        ("skin to aligned mesh", distance),
        ("unit", sequence.unit or "not known"),
        ("frames a second", f"{sequence.fps:g}" if sequence.fps else "not known"),
        ("up", up_direction.up + (", not certain" if up_direction.confidence < UNSURE else "")),
    ]
