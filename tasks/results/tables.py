"""Exports positions, confidence, angles and lengths as CSV tables."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.tables import Tables
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.tables import tables as csv_files


@task(on_request=True)
def tables(skeleton: Skeleton) -> Tables:
    """Writes CSV tables of trajectories, of angles between bones and of bone lengths (ours)."""
    return Tables.of({f"tables/{name}": data for name, data in csv_files(skeleton).items()})
