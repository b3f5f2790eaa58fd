"""The articulated body: one tree of joints over the rigid parts, a pose for every frame, and the skin that follows."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.alignment import Alignment
from kinetree.schemas.articulation import Articulation, ArticulationParams
from kinetree.schemas.leaves import Leaves
from kinetree.schemas.parts import Parts
from kinetree.schemas.reference import Reference
from kinetree.schemas.sequence import Sequence
from kinetree.tasks.numerics.structure import skeleton as structure
from kinetree.tasks.numerics.structure.ends import nearest_vertices
from kinetree.tasks.numerics.structure.fit import doubtful
from kinetree.tasks.numerics.surface import Surface


@task()
def articulation(
    reference: Reference,
    parts: Parts,
    alignment: Mapping[int, Alignment],
    leaves: Leaves,
    sequence: Sequence,
    params: ArticulationParams,
) -> Articulation:
    """Joins the rigid parts into one tree, places its joints and poses it in every frame that is seen (2014, Sec. 6.3)."""
    aligned = list(alignment.values())
    V, F = reference.vertices, reference.faces
    found = structure.skeleton(
        V,
        np.asarray(F, dtype=np.int64),
        np.stack([a.vertices for a in aligned]),
        Surface.of(V, F).area,
        np.asarray(parts.label, dtype=np.int64),
        parts.rotation,
        parts.translation,
        parts.residual,
        tips_of(leaves, reference),
        trust_of(aligned),
        degrees=params.degrees,
        ratio=params.ratio,
    )
    return Articulation(
        frames=tuple(alignment),
        fps=sequence.fps,
        unit=sequence.unit,
        vertices=V,
        faces=F,
        doubted=np.zeros(len(aligned), np.bool_) if reference.fixed else doubtful(found.confidence),
        **{**found._asdict(), "parents": tuple(found.parents.tolist())},
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
