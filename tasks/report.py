"""One page that shows what a run found: the body playing, the curves and the tables a person needs to trust it."""

from collections.abc import Mapping
from html import escape
from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.alignment import Alignment
from kinetree.schemas.correlation import Correlation
from kinetree.schemas.evaluation import Evaluation
from kinetree.schemas.geodesics import Geodesics
from kinetree.schemas.intervals import Intervals
from kinetree.schemas.leaves import Leaves
from kinetree.schemas.mesh import Mesh
from kinetree.schemas.projection import Projection
from kinetree.schemas.reference import Reference
from kinetree.schemas.report import Report, ReportParams
from kinetree.schemas.sequence import Sequence
from kinetree.schemas.skeleton import Skeleton
from kinetree.schemas.traces import Traces
from kinetree.tasks.numerics.scene import spread
from kinetree.tasks.page.document import Page, Section, document, picture, table
from kinetree.tasks.page.heed import counted, heeded, off
from kinetree.tasks.page.scene import Limits, scene
from kinetree.tasks.plots.alignment import alignment as alignment_figure
from kinetree.tasks.plots.evaluation import drawn as errors_figure
from kinetree.tasks.plots.macroscopic import correlation as correlation_figure
from kinetree.tasks.plots.macroscopic import mu as mu_figure
from kinetree.tasks.plots.motion import angles
from kinetree.tasks.plots.structure import confidence, tree
from kinetree.tasks.plots.structure import skeleton as skeleton_figure
from kinetree.tasks.plots.traces import cones, lengths, merging
from kinetree.tasks.plots.traces import structure as structure_figure


@task()
def report(
    skeleton: Skeleton,
    traces: Traces,
    reference: Reference,
    sequence: Sequence,
    correlation: Correlation,
    intervals: Intervals,
    leaves: Leaves,
    evaluation: Evaluation,
    alignment: Mapping[int, Alignment],
    projection: Mapping[int, Projection],
    mesh: Mapping[int, Mesh],
    geodesics: Mapping[int, Geodesics],
    params: ReportParams,
) -> Report:
    """Draws and tells the run on one page that needs no network (ours)."""
    once = {"skeleton": skeleton, "reference": reference, "correlation": correlation, "intervals": intervals, "leaves": leaves}
    once |= {"traces": traces}
    framed = {"alignment": alignment, "mesh": mesh, "geodesics": geodesics}

    def fetch(name: str, frame: int | None = None) -> Any:
        return once[name] if frame is None else framed[name][frame]

    limits = Limits(params.frames, params.vertices, params.input_vertices)
    up = None if params.up is None else "xyz".index(params.up)
    frames = [skeleton.frames[t] for t in spread(len(skeleton.frames), params.views)]
    page = Page(
        title=params.title or f"kinetree: {counted(skeleton.kinds.count('joint'), 'joint')} in {len(skeleton.frames)} frames",
        facts=_facts(skeleton, sequence, reference, intervals, alignment),
        warnings=heeded(skeleton, intervals, leaves, alignment, mesh),
        scene=scene(skeleton, alignment, projection, mesh, leaves, intervals, limits, up),
        sections=[
            Section("structure", "Joints and parts", _structure(fetch, frames, up, skeleton, intervals, traces)),
            *([Section("truth", "Against the truth", _judged(evaluation))] if evaluation.summary is not None else []),
            Section("intervals", "Topology over time", _macroscopic(fetch, frames, up)),
            Section("alignment", "Alignment", _aligned(fetch, frames, up, reference)),
        ],
    )
    return Report(text=np.frombuffer(document(page).encode(), dtype=np.uint8))


def _structure(
    fetch: Any,
    frames: list[int],
    up: int | None,
    skeleton: Skeleton,
    intervals: Intervals,
    traces: Traces,
) -> str:
    varies = traces.variation
    unit = skeleton.unit or "unit of the input"
    rows = [
        (
            name,
            skeleton.kinds[j],
            skeleton.names[parent] if parent >= 0 else "–",
            float(skeleton.lengths[j]),
            f"{varies[j]:.2g}" if parent >= 0 else "–",
            float(skeleton.degrees[j]),
            float(skeleton.drift[j]),
            int(skeleton.support[j]),
            _supporting(skeleton, intervals, j),
            float(skeleton.confidence[:, j].mean()),
        )
        for j, (name, parent) in enumerate(zip(skeleton.names, skeleton.parents, strict=True))
    ]
    head = (
        "joint",
        "kind",
        "parent",
        "bone",
        "varies by, %",
        "turns, °",
        "parts disagree by",
        "frames",
        "intervals",
        "confidence",
    )
    return (
        picture(skeleton_figure(fetch, frames, up), "Parts and skeleton; white where the surface is not rigid.", vector=False)
        + picture(tree(fetch, frames, up), "The tree of joints with lengths of bones and ranges of turning.")
        + picture(confidence(fetch, frames, up), "Confidence of every joint over time, and by what its two parts disagree.")
        + _traced(fetch, frames, up)
        + picture(
            angles(fetch, frames, up), "Turning of every joint since the reference pose; bold where confidence is below a half."
        )
        + f"<p>Lengths in {escape(unit)}; they vary by so much over the frames where every part is followed by itself, before"
        + " they are fixed. Intervals are those in which a joint's confidence is at least a half.</p>"
        + table(head, rows)
    )


def _traced(fetch: Any, frames: list[int], up: int | None) -> str:
    """What the joints were found from (2014, Figs. 7, 11 and 15)."""
    return (
        picture(cones(fetch, frames, up), "Cones around the leaves and their annuli; pale where cones overlap.", vector=False)
        + picture(
            merging(fetch, frames, up),
            "What merging annuli across each border would cost, and the first cut; coloured: parts left, white: shared annuli.",
        )
        + picture(structure_figure(fetch, frames, up), "The graph of parts before, and the tree that was left.", vector=False)
        + picture(lengths(fetch, frames, up), "By what bones' lengths varied before they were held; afterwards by nothing.")
    )


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
    told = "".join(f"<p>{escape(text)}</p>" for text in evaluation.remarks())
    head = ("true joint", "turns, °", "found as", evaluation.unit or "length", "% of the height")
    caption = "Error of every joint over time, mean and deviation beside it (2014, Fig. 16); below, the measures of 2009."
    return told + picture(errors_figure(evaluation), caption) + table(head, rows)


def _macroscopic(fetch: Any, frames: list[int], up: int | None) -> str:
    return picture(
        correlation_figure(fetch, frames, up),
        "C(t) of Eq. 2 with the cuts and the intervals; below, how near every cue came to its threshold.",
    ) + picture(mu_figure(fetch, frames, up), "μ on the surface, from low (dark) to high, with the leaves.", vector=False)


def _aligned(fetch: Any, frames: list[int], up: int | None, reference: Reference) -> str:
    if reference.fixed:
        return "<p>Every frame has the same faces: a vertex is where it is, and there is nothing to align.</p>"
    caption = "Distance of the aligned mesh to every frame, over time and on the surface."
    return picture(alignment_figure(fetch, frames, up), caption, vector=False)


def _facts(
    skeleton: Skeleton,
    sequence: Sequence,
    reference: Reference,
    intervals: Intervals,
    aligned: Mapping[int, Alignment],
) -> list[tuple[str, str]]:
    return [
        ("frames", str(len(skeleton.frames))),
        ("joints", str(skeleton.kinds.count("joint"))),
        ("ends of bones", str(skeleton.kinds.count("leaf"))),
        ("intervals", str(len(intervals.begin))),
        ("reference frame", str(reference.frame)),
        ("skin off the aligned meshes by", f"{100 * off(skeleton, aligned):.2g} % of the body's diagonal"),
        ("unit", sequence.unit or "not known"),
        ("frames a second", f"{sequence.fps:g}" if sequence.fps else "not known"),
    ]
