"""The roll of limbs over the whole sequence, and the stiffness that follows from it."""

import numpy as np

from kinetree.pipeline.task import Previous, task
from kinetree.schemas.array import Floats, Index, Ints
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.refit import Refit
from kinetree.schemas.registration.roll import Roll
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.schemas.registration.stiffness import Stiffness
from kinetree.tasks.numerics.arrays import Ints as Longs
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph as Nodes
from kinetree.tasks.numerics.registration.roll import chosen_rolls
from kinetree.tasks.numerics.registration.roll_candidates import limbs
from kinetree.tasks.numerics.registration.stiffness import (
    learned_stiffness,
    loose_between_clusters,
    loose_limb_ends,
    refit_pass,
)
from kinetree.tasks.registration.pose import graph, rolled_pose


@task(over="pass", along=DeformationGraph, among=Sequence)
def roll(
    deformation_graph: DeformationGraph,
    stiffness: Stiffness,
    recovery: Recovery,
    candidates: tuple[RollCandidates, ...],
    refit: Previous[tuple[Refit, ...]],
    previous: Roll | None,
    index: Index,
) -> Roll:
    """Chooses for every limb the path through its candidates that fits clearly better than where it was tracked (ours)."""
    nodes, frames = graph(deformation_graph), recovery.frames
    cluster, takes = stiffness.cluster.astype(np.int64), take_spans(frames)
    chosen = np.empty((len(frames), 0), np.int32)
    if candidates:
        angle, misfit = (np.stack([getattr(c, name) for c in candidates]) for name in ("angle", "misfit"))
        begins = [take.start for take in takes[1:]]
        chosen = chosen_rolls(angle, misfit, frames.index(deformation_graph.frame), begins=begins).astype(np.int32)
    limb = np.array(previous.limb) if previous is not None else np.full(len(nodes.node), -1, np.int32)
    corrected = np.array(stiffness.stiffness)
    if (chosen >= 0).any():
        limb = _rolled_limbs(nodes, cluster, chosen)
        pairs = zip(refit, candidates, chosen, strict=True)
        poses = [rolled_pose(nodes, r, c, stiffness, row) for r, c, row in pairs]
        corrected = learned_stiffness(nodes, poses, takes=takes)
    return Roll(
        frames=frames,
        candidate=chosen,
        limb=limb,
        stiffness=_held(nodes, corrected, limb, cluster, is_loosened=refit_pass(index[0]).is_loosened),
    )


def _rolled_limbs(nodes: Nodes, cluster: Longs, chosen: Ints) -> Ints:
    """(node,) number of the limb of every node where that limb rolls in some frame, else −1."""
    limb = np.full(len(nodes.node), -1, np.int32)
    for number, one in enumerate(limbs(nodes, cluster)):
        limb[one.node] = number if (chosen[:, number] >= 0).any() else -1
    return limb


def _held(nodes: Nodes, stiffness: Floats, limb: Ints, cluster: Longs, *, is_loosened: bool) -> Floats:
    """Stiffness with rolled limbs rigid and loose at their ends, and looser between rigid clusters where asked for."""
    freed_limbs = loose_limb_ends(nodes, stiffness, limb.astype(np.int64))
    return loose_between_clusters(nodes, freed_limbs, cluster) if is_loosened else freed_limbs
