"""Exports motion, positions, confidence, angles and lengths as tables."""

from pathlib import Path

from kinetree.pipeline.task import task
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.tables import Tables, TablesParams
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.biomechanics import anatomical_table, gait_files, turn_table
from kinetree.tasks.results.formats.placement import renamed
from kinetree.tasks.results.formats.tables import motion_derivatives, table_files
from kinetree.tasks.results.formats.tables import tables as all_tables
from kinetree.tasks.results.formats.takes import bars_of_takes, of_takes


@task(on_request=True)
def tables(
    skeleton: CompleteSkeleton,
    joint_names: JointNames,
    up_direction: UpDirection,
    error_bars: ErrorBars,
    params: TablesParams,
) -> Tables:
    """Writes tables of motion, angles, bone lengths and steps, as CSV or Parquet (ours)."""
    named: dict[str, bytes] = {}
    counts: list[int] = []
    bars = bars_of_takes(error_bars, skeleton)
    known = zip(joint_names.anatomy, error_bars.evidence, strict=False)
    still = {name for name, evidence in known if evidence in ("narrowing", "mirror")}
    for take, body in of_takes(renamed(skeleton, joint_names)).items():
        found = motion_derivatives(body, params.window, params.degree)
        counts += [] if found is None else [found.samples]
        written, more = dict(all_tables(body, found, bars.get(take))), {}
        written["turns"] = turn_table(body)
        if (angles := anatomical_table(body, joint_names, up_direction.up, still)) is not None:
            written["joint_angles"] = angles
        if (gait := gait_files(body, joint_names, up_direction.up)) is not None:
            written["gait"], more["gait.json"] = gait
        files = {**table_files(written, params.form), **more}
        named |= {f"tables/{Path(name).stem}{take}{Path(name).suffix}": data for name, data in files.items()}
    samples = max(counts, default=None)
    span = None if samples is None or not skeleton.fps else samples / skeleton.fps
    return Tables.of(named, samples=samples, seconds=span, degree=params.degree)
