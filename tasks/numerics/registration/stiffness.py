"""Stiffness learned from a whole sequence: edges that never bend lie on bone, edges that bend in some frame at a joint (ours).

A uniform stiffness bends where the body is thin. After one traversal of the sequence every edge of the deformation graph has
shown how far it bends; the next pass holds bones and lets joints bend.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.edges import strains


class StiffnessSettings(NamedTuple):
    """How far bending and known structure lower the stiffness of edges."""

    bending: float = 0.03
    """s₀, relative bending at which an edge counts half. With 0.02 nine bodies turn 0.006 more in the mean and find as many
    joints, but a recorded wolf's vertices err by 0.246 instead of 0.235 % of its height."""
    between_clusters: float = 0.1
    """Share of its stiffness that an edge between two rigid clusters keeps in the last pass. Chosen on every fourth frame of
    four bodies: 46 of 60 joints keep four fifths of their turning, 41 without."""
    limb_ends: float = 0.15
    """Share of its stiffness that an edge at the end of a rolled limb keeps. Chosen on: not recorded."""


class Pass(NamedTuple):
    """What one pass over all frames does.

    fit         : settings of the fit
    clusters    : whether rigid clusters of nodes are sought; those of the pass before stay where not
    roll        : whether lost roll of limbs is sought before the pass
    is_loosened : whether rigid clusters may turn against each other more freely than was learned
    """

    fit: FitSettings
    clusters: bool = False
    roll: bool = False
    is_loosened: bool = False


# every pass starts from the pose of the pass before, so it searches near and once; the first still roughly, the second so
# finely that a section which is not quite round holds its roll
PASSES = (
    Pass(FitSettings(4, (0.24, 0.12), (0.05, 0.027), (0.02, 0.008), (0.01, 0.001), 30, searches=1, thin=1)),
    Pass(
        FitSettings(4, (0.16, 0.08), (0.05, 0.027), (0.008, 0.004), (0.01, 0.001), 30, searches=1, thin=1, beta=0.04),
        clusters=True,
        roll=True,
    ),
    Pass(
        FitSettings(4, (0.06, 0.03), (0.05, 0.027), (0.008, 0.008), (0.01, 0.001), 30, searches=1, thin=1, beta=0.04),
        is_loosened=True,
    ),
)


def refit_pass(number: int) -> Pass:
    """What a pass does, numbered from 0; passes beyond the last of `PASSES` do as that one."""
    return PASSES[min(number, len(PASSES) - 1)]


def learned_stiffness(
    graph: DeformationGraph,
    poses: Sequence[Pose],
    settings: StiffnessSettings | None = None,
    *,
    takes: Sequence[slice] | None = None,
) -> Floats:
    """S = s₀² / (s₀² + q²), q the root mean square over frames of an edge's relative residual (ours).

    Of several takes the one in which an edge bends most decides: what bends in one take is no stiffer for others that hold it.

    graph   : of the reference mesh
    poses   : (frame,) those of a take in any order; at least one
    takes   : positions of the frames of each take; None takes all as one
    returns : (edge,) without unit, above 0, at most 1
    """
    settings = settings or StiffnessSettings()
    g = graph.g
    strain_of_frame = np.stack([strains(graph.edge, *pose, g) for pose in poses])
    # sorted, so that the sum does not depend on the order in which frames arrive
    by_take = [np.sort(strain_of_frame[take], axis=0).mean(axis=0) for take in takes or [slice(None)]]
    strain = np.max(by_take, axis=0)
    return settings.bending**2 / (settings.bending**2 + strain)


def loose_limb_ends(
    graph: DeformationGraph, stiffness: Floats, limb: Ints, settings: StiffnessSettings | None = None
) -> Floats:
    """Stiffness where some limbs are known to roll: rigid in themselves, loose at their ends (ours).

    graph     : of the reference mesh
    stiffness : (edge,) as learned, 0 to 1
    limb      : (node,) number of the rolled limb, −1 for nodes of none
    returns   : (edge,) 0 to 1
    """
    settings = settings or StiffnessSettings()
    a, b = limb[graph.edge[:, 0]], limb[graph.edge[:, 1]]
    return np.where(a != b, settings.limb_ends * stiffness, np.where(a >= 0, 1.0, stiffness))


def loose_between_clusters(
    graph: DeformationGraph, stiffness: Floats, cluster: Ints, settings: StiffnessSettings | None = None
) -> Floats:
    """Stiffness with softer edges between rigid clusters: stiffness learned from half a turn would keep half of it (ours).

    graph     : of the reference mesh
    stiffness : (edge,) as learned, 0 to 1
    cluster   : (node,) number of the cluster, see `rigid_clusters`
    returns   : (edge,) 0 to 1
    """
    settings = settings or StiffnessSettings()
    is_between = cluster[graph.edge[:, 0]] != cluster[graph.edge[:, 1]]
    return np.where(is_between, settings.between_clusters, 1.0) * stiffness
