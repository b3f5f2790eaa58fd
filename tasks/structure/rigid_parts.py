"""The rigid parts of the body."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.rigid_parts import RigidParts, RigidPartsParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.structure import rigid_parts as structure
from kinetree.tasks.numerics.structure.elimination import Bar
from kinetree.tasks.numerics.structure.end_effectors import nearest_vertices


@task()
def rigid_parts(
    reference: Reference, alignment: Mapping[int, Alignment], leaves: Leaves, params: RigidPartsParams
) -> RigidParts:
    """Divides the surface into the rigid parts that the motion shows, as many as would be missed (2014, Sec. 6.1 and 6.2)."""
    aligned = list(alignment.values())
    found = structure.rigid_parts(
        reference.vertices,
        np.asarray(reference.faces, dtype=np.int64),
        np.stack([a.vertices for a in aligned]),
        trust_of(aligned),
        tips_of(leaves, reference),
        structure.RigidPartsSettings(rings=params.rings, patches=params.patches, bar=Bar(removal_cost=params.removal_cost)),
    )
    return RigidParts(
        frames=tuple(alignment),
        label=found.label,
        rigid=found.rigid,
        rotation=found.R,
        translation=found.t,
        residual=found.residual,
    )


def tips_of(leaves: Leaves, reference: Reference) -> NDArray[np.int64]:
    """(leaf,) vertices of the reference mesh at the leaves that count in some interval and are seen in its frame."""
    at = leaves.frames.index(reference.frame)
    seen = (leaves.rows[:, at] >= 0) & leaves.kept.any(axis=0)
    return nearest_vertices(reference.vertices, leaves.positions[seen, at])


def trust_of(aligned: list[Alignment]) -> NDArray[np.float64] | None:
    """(frame, vertex) trust; None where everything is believed."""
    trust = np.stack([a.trust for a in aligned])
    return None if (trust == 1.0).all() else trust
