"""A graph that finds the true skeleton of a generated body, so that an evaluation has something to run on."""

from collections.abc import Mapping

from results.true_skeletons import generated, observed, perfect

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.input.hull import hull
from kinetree.tasks.input.isosurface import isosurface
from kinetree.tasks.input.mesh import mesh
from kinetree.tasks.input.sequence import sequence
from kinetree.tasks.input.source import source
from kinetree.tasks.results.evaluation import evaluation
from kinetree.tasks.results.frame_truth import frame_truth
from kinetree.tasks.results.known_truth import known_truth
from kinetree.tasks.results.truth import truth


@task()
def skeleton(source: Mapping[int, Source]) -> Skeleton:
    """The truth itself; of a folder of meshes, that of the body from which they were written."""
    return perfect(next(iter(source.values())).recipe or generated())


@task(over="frame")
def projection(source: Source, mesh: Mesh) -> Projection:
    """Every vertex lies on its own place of the reference."""
    return next(iter(observed(source.recipe or generated())[2].values()))


GRAPH = Graph.of((source, sequence, truth, hull, isosurface, mesh, projection, skeleton, known_truth, frame_truth, evaluation))
