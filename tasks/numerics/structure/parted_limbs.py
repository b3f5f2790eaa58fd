"""Parts that hold two limbs, cut apart: limbs that move alike are one rigid body, and yet two bones (ours).

In a squat both thighs turn as one. The elimination then makes one part of them, and the pelvis above looks like a ring of
flesh between that part and the trunk. The rigid surface of such a part lies in two pieces, with softer skin between them.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import edge_lengths, ring_edges
from kinetree.tasks.numerics.structure.elimination import NormalisedBody
from kinetree.tasks.numerics.structure.part_motion import misfit, rigid_share


class PartedLimbsSettings(NamedTuple):
    """When the rigid surface of a part lies in several pieces. Chosen on one squatting human, see RESULTS."""

    rigid: float = 0.3
    """Share of a vertex's motion that the part alone explains, from which on the vertex is rigid."""
    piece: float = 0.25
    """Area of each piece, at least, share of the part's: so a part of three limbs is rarely cut, one of four never."""
    limb: float = 0.04
    """Area of each piece, at least, share of the body's. The second piece of both thighs has 0.075 to 0.083 in that human's
    four cuts; those of other parts of 96 bodies that have a quarter of their part too have 0.019 and less."""


def parted(
    body: NormalisedBody, label: Ints, R: Floats, t: Floats, removal_cost: float, settings: PartedLimbsSettings | None = None
) -> tuple[Ints, Ints]:
    """The labels with each large piece of a part's rigid surface as a part of its own; other vertices go to the nearest piece.

    label        : (vertex,) part
    R, t         : (frame, part, 3, 3) · (frame, part, xyz)
    removal_cost : cost from which on a part stays, root of the area
    returns      : (vertex,) part, the new ones last · (part,) the part that each was
    """
    chosen, out, origin = settings or PartedLimbsSettings(), label.copy(), list(range(R.shape[1]))
    rigid = rigid_share(misfit(body.V, body.x, body.weight, R, t, label), removal_cost) >= chosen.rigid
    rigid &= body.weight.any(axis=0)
    edges = edge_lengths(body.V, ring_edges(body.start, body.ring))
    least = chosen.limb * float(body.area.sum())
    for part in range(R.shape[1]):
        own = np.flatnonzero(label == part)
        area = body.area[own]
        piece = _pieces(csr_array(edges[own][:, own]), area, rigid[own], max(chosen.piece * float(area.sum()), least))
        for k in range(1, int(piece.max(initial=0)) + 1):
            out[own[piece == k]] = len(origin)
            origin.append(part)
    return out, np.array(origin)


def _pieces(edges: csr_array, area: Floats, rigid: Flags, least: float) -> Ints:
    """(own vertex,) which piece of the rigid surface, of this area at least, lies nearest along the part's edges; 0 for one."""
    inside = edges * rigid[:, None] * rigid[None]
    inside.eliminate_zeros()
    piece = connected_components(inside, directed=False)[1]
    sizes = np.bincount(piece[rigid], area[rigid], int(piece.max(initial=0)) + 1)
    large = np.flatnonzero(sizes >= least)
    if len(large) < 2:
        return np.zeros(len(area), np.int64)
    away = [dijkstra(edges, indices=np.flatnonzero(rigid & (piece == k)), min_only=True) for k in large]
    return np.argmin(away, axis=0)
