"""Matches of the body and a frame that are nearest in place, normal and colour, and what they add to a fit (ours)."""

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.registration.colour_term import (
    ColourSettings,
    Compared,
    colour_forms,
    compared,
    feature_matches,
    surface_gradient,
)
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph

Pair = tuple[Ints, Ints]
"""Of the body and of the frame."""


def agreeing_colours(
    graph: DeformationGraph, target: Target, samples: Pair, match: Pair, settings: ColourSettings | None = None
) -> Compared | None:
    """The colours of a frame beside the body's at these matches; None where they do not agree, or one has none.

    samples : of the body and of the frame
    match   : the frame's vertex for each of the body's samples · the body's vertex for each of the frame's
    """
    settings = settings or ColourSettings()
    if target.colour is None:
        return None
    vertex, other = np.concatenate([samples[0], match[1]]), np.concatenate([match[0], samples[1]])
    found = compared(target.colour, graph.N, target.N, vertex, other, settings)
    return found if found.share >= settings.agreement else None


def coloured_matches(
    graph: DeformationGraph,
    target: Target,
    samples: Pair,
    x: Floats,
    n: Floats,
    last: Pair | None,
    colour: Compared,
    beta: float,
    settings: ColourSettings | None = None,
) -> Pair:
    """(sample,) the frame's vertex for each of the body's samples · (sample,) the body's vertex for each of the frame's.

    x, n : (vertex, xyz) the body now, mesh unit · (vertex, xyz) unit normals
    last : matches to start from, or None to search among all samples
    beta : what a turn of the normal by one radian counts, mesh unit
    """
    settings = settings or ColourSettings()
    gamma = settings.search * target.size / colour.noise
    P = np.hstack([x, beta * n, gamma * colour.body])
    Q = np.hstack([target.V, beta * target.N, gamma * colour.frame])
    of_body, of_frame = P[samples[0]], Q[samples[1]]
    if last is None:
        last = (
            target.sample[cKDTree(Q[target.sample], balanced_tree=False).query(of_body)[1]],
            samples[0][cKDTree(of_body, balanced_tree=False).query(of_frame)[1]],
        )
    return (
        feature_matches(of_body, last[0], Q, target.start, target.ring),
        feature_matches(of_frame, last[1], P, graph.start, graph.ring),
    )


def forms_of_matches(
    target: Target,
    colour: Compared,
    vertex: Ints,
    other: Ints,
    r: Floats,
    weight: Floats,
    settings: ColourSettings | None = None,
) -> tuple[Floats, Floats, Floats]:
    """What colours add to each match's energy, see `colour_forms`.

    vertex, other : (match,) the body's vertex and the frame's
    r             : (match, xyz) x − y, mesh unit
    weight        : (match,)
    """
    settings = settings or ColourSettings()
    gradient = surface_gradient(target.V, target.N, colour.frame, target.start, target.ring)
    kappa = (settings.hold * target.size / colour.noise) ** 2
    chance = settings.chance**2 * target.colour_noise
    wanted = colour.body[vertex] - colour.frame[other]
    return colour_forms(r, wanted, gradient[other], weight, kappa, colour.noise, settings.outlier, settings.firmest, chance)
