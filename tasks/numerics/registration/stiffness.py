"""Stiffness learned from a whole sequence: what never bends is bone, what bends in some frame is a joint.

A uniform prior bends where the body is thin; after one pass over the sequence every tie of the deformation graph has
shown how much it bends, and the next pass holds on to bones and lets joints go.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.ties import strains

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

YIELD = 0.03  # relative bending at which a tie counts half
LOOSE = 0.1  # of its stiffness a tie between two pieces keeps in the last pass
FREED = 0.15  # of its stiffness a tie keeps that leads to a limb which had lost a twist


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
    Pass(FitSettings(4, (0.24, 0.12), (0.05, 0.027), (0.02, 0.008), (0.01, 0.001), searches=1, thin=1)),
    Pass(
        FitSettings(4, (0.16, 0.08), (0.05, 0.027), (0.008, 0.004), (0.01, 0.001), searches=1, thin=1, beta=0.04),
        clusters=True,
        roll=True,
    ),
    Pass(
        FitSettings(4, (0.06, 0.03), (0.05, 0.027), (0.008, 0.008), (0.01, 0.001), searches=1, thin=1, beta=0.04),
        is_loosened=True,
    ),
)


def learned(template: DeformationGraph, poses: Sequence[Pose], yields: float = YIELD) -> Floats:
    """S = s₀² / (s₀² + q²), q the rms over frames of a tie's relative residual.

    poses   : one a frame, in any order; at least one
    yields  : s₀
    returns : (edge,) above 0, at most 1
    """
    g = template.g
    # sorted, so that the sum does not depend on the order in which frames arrive
    strain = np.sort(np.stack([strains(template.edge, *pose, g) for pose in poses]), axis=0).mean(axis=0)
    return yields**2 / (yields**2 + strain)


def freed(template: DeformationGraph, stiffness: Floats, limb: Ints) -> Floats:
    """Stiffness where some limbs are known to turn: rigid in themselves, loose at their ends.

    stiffness : (edge,) as learned
    limb      : (node,) number of the limb, −1 for nodes of none
    returns   : (edge,)
    """
    a, b = limb[template.edge[:, 0]], limb[template.edge[:, 1]]
    return np.where(a != b, FREED * stiffness, np.where(a >= 0, 1.0, stiffness))


def loosened(template: DeformationGraph, stiffness: Floats, piece: Ints) -> Floats:
    """Stiffness with the ties between pieces that moved apart made softer: what bends there was learned half-heartedly.

    stiffness : (edge,) as learned
    piece     : (node,) number of the piece, see `pieces`
    returns   : (edge,)
    """
    return np.where(piece[template.edge[:, 0]] != piece[template.edge[:, 1]], LOOSE, 1.0) * stiffness
