"""Views of the artifacts of the shelf `results`: exported files, the evaluation, the report."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from kinetree.pipeline.views import files_of, leave_group, page_of, remarks_of
from kinetree.schemas.array import Floats, Index
from kinetree.schemas.results.bvh import Bvh
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.schemas.results.exports import Exported
from kinetree.schemas.results.glb import Glb
from kinetree.schemas.results.ply import Ply
from kinetree.schemas.results.report import RUN, Report
from kinetree.schemas.results.segmentation import Segmentation

leave_group(Segmentation, "segmentation.zarr")


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
        compared = f"{len(evaluation.frames)} of the {evaluation.true_frames} frames"
        lines.append(f"{compared} of {evaluation.truth} are compared; the sequence has no others")
    return tuple(lines)


@remarks_of(Bvh)
def bvh_remarks(bvh: Bvh) -> tuple[str, ...]:
    """Says that frames were interpolated, where they were."""
    if not bvh.between:
        return ()
    return (f"the frames are not evenly spaced, but BVH has one frame time: {bvh.between} frames were interpolated",)


@remarks_of(Glb)
def glb_remarks(glb: Glb) -> tuple[str, ...]:
    """Says that the frame rate or the size is assumed, where it is."""
    rate = f"frame rate not known: {glb.assumed_fps:g} frames a second assumed; set sequence.fps" if glb.assumed_fps else ""
    size = "" if glb.unit else f"unit not known: one unit is assumed to be {glb.scale:g} m; set sequence.unit or glb.scale"
    return tuple(line for line in (rate, size) if line)


@remarks_of(Segmentation)
def segmentation_remarks(segmentation: Segmentation) -> tuple[str, ...]:
    """How near the skinned mesh is to the aligned meshes."""
    unit = f" {segmentation.unit}" if segmentation.unit else ""
    mean = f"distance between the skinned mesh and the aligned meshes: {segmentation.error:.3g}{unit} root mean square"
    return (f"{mean}, 95 % below {segmentation.error_95:.3g}{unit}",)


def _rounded(values: Floats) -> Any:
    """The values as lists of numbers, six digits of each, NaN as None."""
    if values.ndim > 1:
        return [_rounded(row) for row in values]
    return [float(f"{x:.6g}") if np.isfinite(x) else None for x in values]
