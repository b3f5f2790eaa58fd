"""Views of the artifacts of the shelf `results`: exported files, the evaluation, the report."""

import csv
import io
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from kinetree.pipeline.views import files_of, leave_group, page_of, remarks_of, rows_of
from kinetree.schemas.array import Floats, Index
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.bvh import Bvh
from kinetree.schemas.results.c3d import C3d
from kinetree.schemas.results.comparison import Comparison, UnpairedJoint
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.schemas.results.exports import Exported, PlacedFile
from kinetree.schemas.results.glb import Glb
from kinetree.schemas.results.ply import Ply
from kinetree.schemas.results.report import RUN, Report
from kinetree.schemas.results.segmentation import Segmentation
from kinetree.schemas.results.sequence_table import SequenceRow, SequenceTable
from kinetree.schemas.results.tables import Tables
from kinetree.schemas.results.trc import Trc
from kinetree.schemas.results.usd import Usd
from kinetree.tasks.numerics.results.units import METRES
from kinetree.tasks.views.topology import UNSURE

leave_group(Segmentation, "segmentation.zarr")
NAMED_FRAMES = 8
"""Most interpolated frames that are named one by one."""


@files_of(Exported)
def exported_files(exported: Exported, index: Index) -> Mapping[str, bytes]:
    """The files of an export by name."""
    ends = np.cumsum(exported.sizes, dtype=np.int64).tolist()
    content = exported.content.tobytes()
    rows = zip(exported.names, exported.sizes, ends, strict=True)
    return {name: content[end - size : end] for name, size, end in rows}


@files_of(Ply)
def ply_files(ply: Ply, index: Index) -> Mapping[str, bytes]:
    """The file of one frame, named by the frame's number."""
    (data,) = exported_files(ply, index).values()
    return {f"parts/frame_{index[0]:04d}.ply": data}


@files_of(Evaluation)
def evaluation_files(evaluation: Evaluation, index: Index) -> Mapping[str, bytes]:
    """evaluation.json with all fields, missing errors as null; no file where there is no truth."""
    if evaluation.summary is None:
        return {}
    series = {name: _rounded(values) for name, values in evaluation.arrays().items()}
    content = {"format": "kinetree.evaluation/1", **evaluation.plain(), **series}
    return {"evaluation.json": (json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()}


@page_of(Report, "report.html")
def report_page(report: Report, run: Mapping[str, Any]) -> bytes:
    """The page with the record of the run inserted, as JSON that cannot end the script element around it."""
    text = json.dumps(run, ensure_ascii=True).replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
    return report.text.tobytes().replace(RUN.encode(), text.encode(), 1)


@remarks_of(Evaluation)
def evaluation_remarks(evaluation: Evaluation) -> tuple[str, ...]:
    """How many joints were found, their mean error, and which are missing."""
    summary = evaluation.summary
    if summary is None:
        return ()
    mean = "" if summary.percent is None else f", mean error {summary.percent:.2f} % of the height"
    spurious = f", {summary.spurious} spurious" if summary.spurious else ""
    lines = [f"{summary.found} of {summary.scored} joints found{mean}{spurious}"]
    missing = [joint.name for joint in evaluation.joints if joint.scored and joint.found is None]
    if missing:
        lines.append(f"missing: {', '.join(missing)}")
    if evaluation.true_frames != len(evaluation.frames):
        compared = f"{len(evaluation.frames)} measured frames are compared"
        lines.append(f"{compared}; {evaluation.truth} has {evaluation.true_frames}: interpolated and missing ones do not count")
    return tuple(lines)


@remarks_of(AssumedJoints)
def assumed_joints_remarks(assumed: AssumedJoints) -> tuple[str, ...]:
    """Names the joints that files have and that were not found."""
    names = ", ".join(joint.name for joint in assumed.joints)
    return (f"assumed in files, not found: {names}",) if names else ()


@remarks_of(Bvh)
def bvh_remarks(bvh: Bvh) -> tuple[str, ...]:
    """Says what is assumed, and that frames were interpolated, where they were."""
    uneven = f"the frames are not evenly spaced, but BVH has one frame time: {bvh.between} frames were interpolated"
    return (*placed_remarks(bvh, "bvh.scale"), *([uneven] if bvh.between else []))


@remarks_of(Glb)
def glb_remarks(glb: Glb) -> tuple[str, ...]:
    """Says what is assumed of the input."""
    return (*placed_remarks(glb, "glb.scale"), *glb.missing)


@remarks_of(Trc)
def trc_remarks(trc: Trc) -> tuple[str, ...]:
    """Says what is assumed of the input."""
    return placed_remarks(trc, "trc.scale")


@remarks_of(C3d)
def c3d_remarks(c3d: C3d) -> tuple[str, ...]:
    """Says what is assumed of the input."""
    return placed_remarks(c3d, "c3d.scale")


@remarks_of(Usd)
def usd_remarks(usd: Usd) -> tuple[str, ...]:
    """Says what is assumed of the input."""
    return placed_remarks(usd, "usd.scale")


def placed_remarks(file: PlacedFile, scale: str) -> tuple[str, ...]:
    """Says that the frame rate, the unit or the up direction of the input is assumed, where it is.

    scale : name of the parameter that says the unit
    """
    rate = f"frame rate not known: {file.assumed_fps:g} frames a second assumed; set sequence.fps" if file.assumed_fps else ""
    unit = next((unit for unit in METRES if METRES[unit] == file.metres), f"{file.metres} m")
    stated = f"unit {file.unknown_unit!r} is not known" if file.unknown_unit else "unit not known"
    guess = f"{stated}: by the size of the body, one unit is taken for 1 {unit}"
    size = f"{guess}; set sequence.unit or {scale}" if file.metres_from == "size" else ""
    up = f"up direction not certain: {file.up} of the input is taken to point up; set up_direction.up"
    return tuple(line for line in (rate, size, up if file.up_confidence < UNSURE else "") if line)


@remarks_of(Tables)
def tables_remarks(tables: Tables) -> tuple[str, ...]:
    """How velocities were smoothed, or why there are none."""
    if tables.samples is None:
        return ("frame rate not known: no velocities and accelerations; set sequence.fps",)
    over = f"{tables.samples} frames ({tables.seconds:.3g} s)"
    return (f"velocities and accelerations: Savitzky-Golay over {over}, polynomials of degree {tables.degree}",)


@remarks_of(Segmentation)
def segmentation_remarks(segmentation: Segmentation) -> tuple[str, ...]:
    """How near the skinned mesh is to the aligned meshes."""
    unit = f" {segmentation.unit}" if segmentation.unit else ""
    mean = f"distance between the skinned mesh and the aligned meshes: {segmentation.error:.3g}{unit} root mean square"
    return (f"{mean}, 95 % below {segmentation.error_95:.3g}{unit}",)


@files_of(Comparison)
def comparison_files(comparison: Comparison, index: Index) -> Mapping[str, bytes]:
    """comparison.json with all fields, missing errors as null."""
    series = {name: _rounded(values) for name, values in comparison.arrays().items()}
    content = {"format": "kinetree.comparison/1", **comparison.plain(), **series}
    return {"comparison.json": (json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()}


def comparison_rows(comparison: Comparison) -> list[tuple[str, str, str]]:
    """Name of each figure and its value in both runs."""
    rows = {
        "method": [run.method for run in (comparison.a, comparison.b)],
        "joints found": [_of(run.found, run.scored) for run in (comparison.a, comparison.b)],
        "mean error": [_percent(run.percent) for run in (comparison.a, comparison.b)],
        "mean error of joints both found": [_percent(run.common_percent) for run in (comparison.a, comparison.b)],
        "spurious": ["–" if run.spurious is None else str(run.spurious) for run in (comparison.a, comparison.b)],
        "joints": [str(run.joints) for run in (comparison.a, comparison.b)],
        "leaves": [str(run.leaves) for run in (comparison.a, comparison.b)],
        "bones": [str(run.bones) for run in (comparison.a, comparison.b)],
        "frames": [str(run.frames) for run in (comparison.a, comparison.b)],
        "seconds of computing": [f"{run.seconds:.1f}" for run in (comparison.a, comparison.b)],
    }
    of_truth = {"joints found", "mean error", "mean error of joints both found", "spurious"}
    return [(name, *row) for name, row in rows.items() if comparison.truth or name not in of_truth]  # type: ignore[misc]


@remarks_of(Comparison)
def comparison_remarks(comparison: Comparison) -> tuple[str, ...]:
    """By which rule joints are paired, how far they are apart, and which joints only one run has."""
    unit = f" {comparison.unit}" if comparison.unit else ""
    limit = f"{100 * comparison.limit:g} % of the height ({comparison.limit * comparison.height:.3g}{unit})"
    paired = sum(pair.kind == "joint" for pair in comparison.pairs)
    mean = "" if comparison.mean_percent is None else f", mean distance {comparison.mean_percent:.2f} % of the height"
    lines = [f"the same joint in both: {paired} of {comparison.a.joints} and {comparison.b.joints}{mean}"]
    for letter, only in (("A", comparison.only_a), ("B", comparison.only_b)):
        if only:
            lines.append(f"only in {letter}: {', '.join(map(unpaired_joint, only))}")
    missing = [joint for joint in comparison.true_joints if joint.scored and (joint.a is None) != (joint.b is None)]
    for letter, names in (("A", [j.name for j in missing if j.b is None]), ("B", [j.name for j in missing if j.a is None])):
        if names:
            lines.append(f"true joints found by {letter} alone: {', '.join(names)}")
    rule = "two joints are the same if each is the nearest of its kind to the other, by the mean distance over all frames"
    return (*lines, f"{rule}, and not farther than {limit}")


def unpaired_joint(joint: UnpairedJoint) -> str:
    """A joint that only one run has, with its kind where it is not a joint, and how far the nearest of the other run is."""
    kind = "" if joint.kind in ("joint", joint.name) else f"{joint.kind} "
    near = "" if joint.percent is None else f" (nearest {joint.nearest}, {joint.percent:.1f} %)"
    return f"{kind}{joint.name}{near}"


def _of(count: int | None, total: int | None) -> str:
    return "–" if count is None else f"{count} of {total}"


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f} %"


def _rounded(values: Floats) -> Any:
    """The values as lists of numbers, six digits of each, NaN as None."""
    if values.ndim > 1:
        return [_rounded(row) for row in values]
    return [float(f"{x:.6g}") if np.isfinite(x) else None for x in values]


@remarks_of(CompleteSkeleton)
def complete_skeleton_remarks(skeleton: CompleteSkeleton) -> tuple[str, ...]:
    """Names the frames that were interpolated, with the reasons."""
    reasons = [f"frame {each.frame}: interpolated, {each.reason or 'no file has its number'}" for each in skeleton.interpolated]
    more = len(reasons) - NAMED_FRAMES
    return (*reasons[:NAMED_FRAMES], *([f"{more} more frames were interpolated"] if more > 0 else []))


@rows_of(SequenceTable)
def sequence_rows(table: SequenceTable) -> list[dict[str, Any]]:
    """One row a sequence: what became of it and its figures; numbers of remarks and failures in place of sentences."""
    return [_sequence_row(row) for row in table.rows]


@files_of(SequenceTable)
def sequence_table_files(table: SequenceTable, index: Index) -> Mapping[str, bytes]:
    """The table as CSV, with all sentences as JSON, and as a page."""
    from kinetree.tasks.results.formats.tables import spreadsheet_cell
    from kinetree.tasks.results.page.index import index_page  # which reads the page's style

    rows = sequence_rows(table)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else ["name"], lineterminator="\r\n")
    writer.writeheader()
    writer.writerows({name: spreadsheet_cell(value) for name, value in row.items()} for row in rows)
    full = [
        {**small, "remarks": list(row.outcome.remarks), "failures": list(row.outcome.failures)}
        for small, row in zip(rows, table.rows, strict=True)
    ]
    content = {"format": "kinetree.summary/1", "sequences": full}
    return {
        "summary.csv": text.getvalue().encode(),
        "summary.json": (json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode(),
        "index.html": index_page(table).encode(),
    }


def _sequence_row(row: SequenceRow) -> dict[str, Any]:
    outcome = row.outcome
    identity = {"name": outcome.name, "status": outcome.status, "method": outcome.method, "output": outcome.output}
    figures = row.model_dump(mode="json", exclude={"outcome", "picture"})
    counts = {"seconds": outcome.seconds, "remarks": len(outcome.remarks), "failures": len(outcome.failures)}
    return {**identity, **figures, **counts}
