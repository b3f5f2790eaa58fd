"""What people see of the results and take away: exports, the evaluation, the report."""

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
    """The files, by name."""
    ends = np.cumsum(exported.sizes, dtype=np.int64).tolist()
    content = exported.content.tobytes()
    each = zip(exported.names, exported.sizes, ends, strict=True)
    return {name: content[end - size : end] for name, size, end in each}


@files_of(Ply)
def ply_files(ply: Ply, index: Index) -> Mapping[str, bytes]:
    """The file, named by the frame."""
    (data,) = exported_files(ply, index).values()
    return {f"parts/frame_{index[0]:04d}.ply": data}


@files_of(Evaluation)
def evaluation_files(evaluation: Evaluation, index: Index) -> Mapping[str, bytes]:
    """Nothing without a truth, else evaluation.json: all of it, an error that is not there as null."""
    if evaluation.summary is None:
        return {}
    series = {name: _rounded(values) for name, values in evaluation.arrays().items()}
    told = {"format": "kinetree.evaluation/1", **evaluation.plain(), **series}
    return {"evaluation.json": (json.dumps(told, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()}


@page_of(Report, "report.html")
def report_page(report: Report, run: Mapping[str, Any]) -> bytes:
    """The page with what ran laid into it, as JSON that cannot end the element it lies in."""
    text = json.dumps(run, ensure_ascii=True).replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
    return report.text.tobytes().replace(RUN.encode(), text.encode(), 1)


@remarks_of(Evaluation)
def evaluation_remarks(evaluation: Evaluation) -> tuple[str, ...]:
    """How many joints were found and how well, and which are missing."""
    told = evaluation.summary
    if told is None:
        return ()
    mean = "" if told.percent is None else f" at {told.percent:.2f} % of the height"
    extra = f", {told.spurious} spurious" if told.spurious else ""
    lines = [f"{told.found} of {told.scored} joints found{mean}{extra}"]
    missing = [joint.name for joint in evaluation.joints if joint.scored and joint.found is None]
    if missing:
        lines.append(f"missing: {', '.join(missing)}")
    if evaluation.true_frames != len(evaluation.frames):
        of = f"{evaluation.truth} has {evaluation.true_frames} frames"
        lines.append(f"{of}, of which {len(evaluation.frames)} are compared")
    return tuple(lines)


@remarks_of(Bvh)
def bvh_remarks(bvh: Bvh) -> tuple[str, ...]:
    """That frames were put in between, where they were."""
    told = f"the frames are not evenly spaced: {bvh.between} were put in between, as BVH has one frame time"
    return (told,) if bvh.between else ()


@remarks_of(Glb)
def glb_remarks(glb: Glb) -> tuple[str, ...]:
    """That the pace or the size is a guess, where it is."""
    pace = f"nobody says how fast the sequence is: played at {glb.assumed_fps} frames a second; set sequence.fps"
    size = f"nobody says what the unit is: one was taken for {glb.scale:g} m; set sequence.unit or glb.scale"
    return (*([] if glb.assumed_fps is None else [pace]), *([] if glb.unit is not None else [size]))


@remarks_of(Segmentation)
def segmentation_remarks(segmentation: Segmentation) -> tuple[str, ...]:
    """How well the skeleton explains the surface."""
    unit = f" {segmentation.unit}" if segmentation.unit else ""
    told = f"skinned to the skeleton the mesh is off the aligned ones by {segmentation.error:.3g}{unit} (root mean square)"
    return (f"{told}, 95 % below {segmentation.error_95:.3g}{unit}",)


def _rounded(values: Floats) -> Any:
    """The values as lists of numbers, six digits of each, NaN as None."""
    if values.ndim > 1:
        return [_rounded(row) for row in values]
    return [float(f"{x:.6g}") if np.isfinite(x) else None for x in values]
