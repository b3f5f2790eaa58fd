"""The articulated body: one tree of joints over the rigid parts, a pose for every frame, and the skin that follows."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.kinematic_tree import KinematicTree, KinematicTreeParams
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure import kinematic_tree as structure
from kinetree.tasks.numerics.structure.joint_evidence import Seen
from kinetree.tasks.numerics.structure.pose_refinement import doubtful
from kinetree.tasks.structure.rigid_parts import tips_of, trust_of


@task()
def kinematic_tree(
    reference: Reference,
    parts: RigidParts,
    alignment: Mapping[int, Alignment],
    mesh: Mapping[int, Mesh],
    leaves: Leaves,
    sequence: Sequence,
    params: KinematicTreeParams,
) -> KinematicTree:
    """Joins the rigid parts into one tree, places its joints and poses it in every frame that is seen (2014, Sec. 6.3)."""
    aligned = list(alignment.values())
    V, F = reference.vertices, reference.faces
    found = structure.kinematic_tree(
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
        None if reference.fixed else _seen(aligned, mesh, tuple(alignment)),
        degrees=params.degrees,
        ratio=params.ratio,
    )
    return KinematicTree(
        frames=tuple(alignment),
        fps=sequence.fps,
        unit=sequence.unit,
        vertices=V,
        faces=F,
        doubted=np.zeros(len(aligned), np.bool_) if reference.fixed else doubtful(found.confidence),
        **{**found._asdict(), "parents": tuple(found.parents.tolist())},
    )


def _seen(aligned: list[Alignment], mesh: Mapping[int, Mesh], frames: tuple[int, ...]) -> Seen:
    """What the frames know; their meshes are read where they are asked."""
    return Seen(
        np.stack([a.trust for a in aligned]),
        np.stack([a.residual for a in aligned]),
        lambda t: (np.array(mesh[frames[t]].vertices, np.float64), np.array(mesh[frames[t]].faces, np.int64)),
    )
