"""Parts of the body on the surfaces of a few frames."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.extended_tree import ExtendedTree
from kinetree.schemas.structure.laid_parts import LaidParts
from kinetree.tasks.numerics.structure import laid_parts as numerics
from kinetree.tasks.structure.arguments.joint_tree import restored
from kinetree.tasks.structure.arguments.surfaces import area_of, prepared


@task(over="laid")
def laid_parts(reference: Reference, extended_tree: ExtendedTree, mesh: Mapping[int, Mesh]) -> LaidParts:
    """Lays the parts on the frames' own surfaces, each by itself, and in pairs with a hinge (ours)."""
    V, F, area = area_of(reference)
    surface = prepared(mesh, extended_tree.frames, float(np.sqrt(area.sum())))
    surfaces = {t: surface(t) for t in map(extended_tree.frames.index, mesh)}
    laid = numerics.laid_parts(V, F, area, restored(extended_tree), surfaces)._asdict()
    hinges = laid.pop("hinges")
    return LaidParts(**laid, hinge_joint=hinges.joint, hinge_end=hinges.end, hinge_square=hinges.square)
