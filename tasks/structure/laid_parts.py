"""Parts of the body on the surfaces of a few frames."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.laid_parts import LaidParts
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure import laid_parts as numerics
from kinetree.tasks.numerics.structure.hinged_piece import SAMPLE
from kinetree.tasks.structure.first_tree import restored


@task(over="laid")
def laid_parts(reference: Reference, first_tree: FirstTree, mesh: Mapping[int, Mesh]) -> LaidParts:
    """Lays the parts on the frames' own surfaces, each by itself (ours)."""
    V, F = np.array(reference.vertices), np.array(reference.faces, np.int64)
    area = surface_areas(V, F)
    size = float(np.sqrt(area.sum()))
    surfaces = {
        first_tree.frames.index(frame): Target.of(np.array(m.vertices), np.array(m.faces, np.int64), size, SAMPLE)
        for frame, m in mesh.items()
    }
    return LaidParts(**numerics.laid_parts(V, F, area, restored(first_tree), surfaces)._asdict())


def joined(laid: tuple[LaidParts, ...]) -> numerics.LaidParts | None:
    """All frames together, as the numerics take them; None where no part was laid."""
    if not laid:
        return None
    rows = {name: np.concatenate([getattr(run, name) for run in laid]) for name in LaidParts.model_fields if name != "joint"}
    return numerics.LaidParts(joint=np.array(laid[0].joint), **rows)
