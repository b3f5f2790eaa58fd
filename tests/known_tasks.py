"""A graph that finds the true skeleton of a generated body, so that an evaluation has something to run on."""

from collections.abc import Mapping

from known import generated, observed, perfect

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import task
from kinetree.schemas.mesh import Mesh
from kinetree.schemas.projection import Projection
from kinetree.schemas.skeleton import Skeleton
from kinetree.schemas.source import Source
from kinetree.tasks.evaluation import evaluation
from kinetree.tasks.mesh import mesh
from kinetree.tasks.source import source
from kinetree.tasks.truth import truth


@task()
def skeleton(source: Mapping[int, Source]) -> Skeleton:
    """The truth itself; of a folder of meshes, that of the body from which they were written."""
    return perfect(next(iter(source.values())).recipe or generated())


@task(over="frame")
def projection(source: Source, mesh: Mesh) -> Projection:
    """Every vertex lies on its own place of the reference."""
    return next(iter(observed(source.recipe or generated())[2].values()))


GRAPH = Graph.of((source, truth, mesh, projection, skeleton, evaluation))
