"""Last parts of limbs, and the trunk, on the surfaces of a few frames, with a hinge at rings across them."""

from collections.abc import Mapping
from functools import cache

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.agreed_tree import AgreedTree
from kinetree.schemas.structure.end_rings import EndRings
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.structure import end_rings as numerics
from kinetree.tasks.numerics.structure.limb_pairs import limb_pairs
from kinetree.tasks.numerics.structure.surface_evidence import all_end_rings
from kinetree.tasks.structure.arguments.aligned_body import tips_of
from kinetree.tasks.structure.arguments.joint_tree import restored
from kinetree.tasks.structure.arguments.surfaces import area_of, prepared


@task(over="judged")
def end_rings(
    reference: Reference,
    agreed_tree: AgreedTree,
    alignment: Mapping[int, Alignment],
    mesh: Mapping[int, Mesh],
    leaves: Leaves,
) -> EndRings:
    """Lays last parts of limbs and the trunk on the frames' surfaces, as one piece and with a hinge at several rings (ours)."""
    V, F, area = area_of(reference)
    tree, frame = restored(agreed_tree), np.array([agreed_tree.frames.index(f) for f in mesh])
    pairs = limb_pairs(V, F, tips_of(reference, leaves))
    rings = all_end_rings(V, F, area, tree, pairs)
    confidence = np.stack([a.confidence for a in alignment.values()], dtype=np.float64)
    surface = cache(prepared(mesh, agreed_tree.frames, float(np.sqrt(area.sum()))))
    fits: list[numerics.Fits] = [{} for _ in rings]
    numerics.lay_rings(numerics.EndFrames.of(tree, area, frame, confidence, surface), frame, rings, fits)
    return EndRings(**numerics.EndRings.of(frame, fits)._asdict())
