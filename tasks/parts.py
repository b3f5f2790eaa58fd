"""The rigid parts of the body."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.alignment import Alignment
from kinetree.schemas.leaves import Leaves
from kinetree.schemas.parts import Parts, PartsParams
from kinetree.schemas.reference import Reference
from kinetree.tasks.numerics.structure import parts as structure
from kinetree.tasks.numerics.structure.elimination import Bar
from kinetree.tasks.numerics.structure.ends import nearest_vertices


@task()
def parts(reference: Reference, alignment: Mapping[int, Alignment], leaves: Leaves, params: PartsParams) -> Parts:
    """Divides the surface into the rigid parts that the motion shows, as many as would be missed (2014, Sec. 6.1 and 6.2)."""
    aligned = list(alignment.values())
    found = structure.parts(
        reference.vertices,
        np.asarray(reference.faces, dtype=np.int64),
        np.stack([a.vertices for a in aligned]),
        trust_of(aligned),
        tips_of(leaves, reference),
        structure.PartsSettings(rings=params.rings, patches=params.patches, bar=Bar(missed=params.missed)),
    )
    return Parts(
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
