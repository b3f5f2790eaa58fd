"""The integrated structure in every frame."""

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2009.graph_deformation import GraphDeformation
from kinetree.schemas.paper_2009.graph_motion import GraphMotion, GraphMotionParams
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.schemas.paper_2009.perg import Perg
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.paper_2009.graph_deformation import deformed_model


@task(over="frame", along=IntegratedStructure)
def graph_motion(
    index: Index,
    integrated_structure: IntegratedStructure,
    deformations: tuple[GraphDeformation, ...],
    perg: Perg,
    mesh: Mesh,
    leaves: Leaves,
    previous: GraphMotion | None,
    params: GraphMotionParams,
) -> GraphMotion:
    """Describes the motion in every frame by the integrated structure, matched to its graph (2009, Sec. 2.5)."""
    for known in deformations:
        if known.structure == integrated_structure.structure:
            return GraphMotion(fitted_here=False, **{name: getattr(known, name) for name in GraphDeformation.model_fields})
    fields = deformed_model(index[0], integrated_structure, perg, mesh, leaves, previous, params)
    return GraphMotion(fitted_here=True, structure=integrated_structure.structure, **fields)
