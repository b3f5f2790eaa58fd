"""Exports motion, positions, confidence, angles and lengths as tables."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.tables import Tables, TablesParams
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.tasks.results.formats.placement import renamed
from kinetree.tasks.results.formats.tables import motion_derivatives, table_files
from kinetree.tasks.results.formats.tables import tables as all_tables


@task(on_request=True)
def tables(skeleton: CompleteSkeleton, joint_names: JointNames, params: TablesParams) -> Tables:
    """Writes tables of motion, of angles between bones and of bone lengths, as CSV or Parquet (ours)."""
    body = renamed(skeleton, joint_names)
    found = motion_derivatives(body, params.window, params.degree)
    files = table_files(all_tables(body, found), params.form)
    samples = None if found is None else found.samples
    span = None if samples is None or not skeleton.fps else samples / skeleton.fps
    named = {f"tables/{name}": data for name, data in files.items()}
    return Tables.of(named, samples=samples, seconds=span, degree=params.degree)
