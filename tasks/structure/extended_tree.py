"""The agreed tree with the joints at ends of limbs and within the trunk that the frames' surfaces alone show."""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.agreed_tree import AgreedTree
from kinetree.schemas.structure.end_rings import EndRings
from kinetree.schemas.structure.extended_tree import ExtendedTree, ExtendedTreeParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.structure import end_rings as rings_numerics
from kinetree.tasks.numerics.structure.laid_parts import laid_frames
from kinetree.tasks.numerics.structure.shown_joints import with_end_joints
from kinetree.tasks.numerics.structure.tree_joints import NOISE
from kinetree.tasks.structure.arguments.aligned_body import aligned_body
from kinetree.tasks.structure.arguments.joint_tree import fields_of, restored
from kinetree.tasks.structure.arguments.surfaces import prepared

READY = 64
"""Most surfaces that are kept prepared at a time: rings are judged in 52 frames of a take."""


@task(among=Sequence, block="kinematic_tree")
def extended_tree(
    reference: Reference,
    agreed_tree: AgreedTree,
    end_rings: tuple[EndRings, ...],
    alignment: Mapping[int, Alignment],
    mesh: Mapping[int, Mesh],
    leaves: Leaves,
    params: ExtendedTreeParams,
) -> ExtendedTree:
    """Adds the joints that the frames' surfaces alone show, and says on which frames parts are laid (ours)."""
    frames, tree = agreed_tree.frames, restored(agreed_tree)
    if end_rings:
        body = aligned_body(reference, alignment, leaves)
        tree = with_end_joints(
            body.surface,
            tree,
            body.tips,
            _fits(end_rings),
            lru_cache(maxsize=READY)(prepared(mesh, frames, body.surface.size)),
            np.asarray(body.trust, np.float64),
            NOISE * body.surface.size,
        )
    laid = laid_frames(len(frames)).tolist() if params.surface_joints and not agreed_tree.is_given else []
    return ExtendedTree(
        frames=frames,
        cut_frame=agreed_tree.cut_frame,
        laid=tuple(frames[t] for t in laid),
        shown=tree.shown,
        end_positions=tree.end_x,
        **fields_of(tree),
    )


def _fits(end_rings: tuple[EndRings, ...]) -> list[rings_numerics.Fits]:
    """By ring, how its part lies in all judged frames."""
    names = rings_numerics.EndRings._fields
    runs = [rings_numerics.EndRings(*(np.array(getattr(run, name)) for name in names)) for run in end_rings]
    return rings_numerics.EndRings.joined(runs).fits
