"""The input mesh of one frame as the player of the report shows it."""

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.coarse_mesh import CoarseMesh, CoarseMeshParams
from kinetree.schemas.results.excerpt import Excerpt
from kinetree.tasks.results.page.coarse import coarse


@task(over="shown/frame", along=Excerpt)
def coarse_mesh(mesh: Mesh, projection: Projection, previous: CoarseMesh | None, params: CoarseMeshParams) -> CoarseMesh:
    """Decimates the frame's mesh, or takes the same vertices as in an earlier frame with the same faces (ours)."""
    return coarse(mesh, projection, previous, params.vertices)
