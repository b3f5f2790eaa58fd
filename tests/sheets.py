"""A sheet that folds from frame to frame, its vertices numbered anew in each: every correspondence is known exactly.

Geodesic distances never change, so that geodesic coordinates map each vertex onto itself.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapes import flat_grid, folded

from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.paper_2014.aligned_reference import AlignedReferenceParams
from kinetree.schemas.paper_2014.geodesic_coordinates import GeodesicCoordinates
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.paper_2014.aligned_reference import aligned_reference
from kinetree.tasks.paper_2014.geodesic_coordinates import geodesic_coordinates
from kinetree.tasks.paper_2014.interval_reference import interval_reference

SHEET, FACES = flat_grid(14, 9)
CORNERS = np.array([0, 8, 13 * 9])
CHANGING = Connectivity(fixed=False, first_change=1, vertices=len(SHEET), faces=len(FACES))
TRACKED = Connectivity(fixed=True, first_change=None, vertices=len(SHEET), faces=len(FACES))


@dataclass(frozen=True)
class Frame:
    """One frame, and the number in it of each of the sheet's vertices."""

    mesh: Mesh
    extrema: Extrema
    geodesics: Geodesics
    coordinates: GeodesicCoordinates
    number: NDArray[np.int64]


def frame(t: int, *, hidden: tuple[int, ...] = (), bend: float = 0.15, anew: bool = True) -> Frame:
    """The sheet in a frame; of its three leaves some may be hidden, the others stand in another order in each frame."""
    V = folded(SHEET, 6.0, bend * t)
    order = np.random.default_rng(t).permutation(len(V)) if anew else np.arange(len(V))
    number = np.argsort(order)
    mesh = Mesh(vertices=V[order], faces=number[FACES].astype(np.int32), vertex_of_input=np.arange(len(V)), cleaning=Cleaning())
    visible = np.array([n for n in np.roll([0, 1, 2], t) if n not in hidden], np.int64)
    vertex = number[CORNERS[visible]]
    X = V[CORNERS[visible]]
    extrema = Extrema(
        vertices=vertex, persistence=np.full(len(visible), 0.5), stems=np.stack([0 * X, X], axis=1),
        normals=np.tile([0.0, 0.0, 1.0], (len(visible), 1)), value=np.full(len(visible), 0.7), peaks=np.full(len(visible), 0.5),
        loops=np.zeros(0), size=10.0, centre=(0.0, 0.0, 0.0), euler=1, components=1,
    )  # fmt: skip
    area = np.full(len(V), 13 * 8 / len(V))
    geodesics = Geodesics(mu=np.ones(len(V)), area=area, bases=np.zeros(0, np.int64), share=1.0)
    return Frame(mesh, extrema, geodesics, geodesic_coordinates(mesh, extrema), number)


def leaves_of(frames: dict[int, Frame], *ends: int) -> Leaves:
    """The leaves, of which leaf n is corner n, in intervals that end at these positions."""
    count = len(frames)
    rows, positions = np.full((3, count), -1), np.full((3, count, 3), np.nan)
    for t, here in enumerate(frames.values()):
        for leaf in range(3):
            row = np.flatnonzero(here.extrema.vertices == here.number[CORNERS[leaf]])
            if len(row):
                rows[leaf, t], positions[leaf, t] = row[0], here.extrema.stems[row[0], -1]
    begin = [0, *(e + 1 for e in ends[:-1])]
    is_kept = np.array([(rows[:, a : b + 1] >= 0).mean(axis=1) >= 0.5 for a, b in zip(begin, ends, strict=True)])
    none = np.zeros(0, np.int64)
    return Leaves(frames=tuple(frames), rows=rows, positions=positions, kept=is_kept, lost=none, lost_begin=none, lost_end=none)


def reference_of(
    frames: dict[int, Frame], interval: int, *ends: int, connectivity: Connectivity = CHANGING
) -> IntervalReference:
    """The reference of one of the intervals that end at these positions."""
    begin = [0, *(e + 1 for e in ends[:-1])]
    own = {t: frames[t] for t in tuple(frames)[begin[interval] : ends[interval] + 1]}
    return interval_reference(
        (interval,),
        {t: f.mesh for t, f in own.items()},
        {t: f.geodesics for t, f in own.items()},
        {t: f.coordinates for t, f in own.items()},
        leaves_of(frames, *ends),
        connectivity,
    )


def reference_at(frames: dict[int, Frame], chosen: int) -> Reference:
    """The default's reference, from the chosen frame."""
    mesh, each = frames[chosen].mesh, np.ones(len(frames))
    return Reference(
        frames=tuple(frames), frame=chosen, fixed=False, leaves=3, free=True, vertices=mesh.vertices, faces=mesh.faces,
        size=10.0, stems=np.zeros((0, 4, 3)), score=each,
    )  # fmt: skip


def aligned_reference_of(
    frames: dict[int, Frame], reference: Reference, threshold: float = 0.2, ends: tuple[int, ...] = ()
) -> IntervalReference:
    """The reference of the interval that has these frames, from the default's; the sequence may be cut behind some frames."""
    end = np.array([*ends, len(frames) - 1])
    none = np.zeros(len(frames) - 1)
    return aligned_reference(
        reference,
        {t: f.geodesics for t, f in frames.items()},
        {t: f.extrema for t, f in frames.items()},
        Intervals(
            frames=tuple(frames),
            begin=np.array([0, *(end[:-1] + 1)]),
            end=end,
            z=none,
            cues=((),) * len(ends),
            strengths=none[None],
            cue_names=("correlation",),
            threshold=0.0,
        ),
        AlignedReferenceParams(threshold=threshold),
    )


def exact(number: NDArray[np.int64], here: Frame) -> Alignment:
    """The sheet in a frame, its vertices numbered as in the reference that has these numbers."""
    x = np.empty_like(here.mesh.vertices)
    x[number] = here.mesh.vertices[here.number]
    plain = np.ones(len(x))
    return Alignment(vertices=x, residual=0 * plain, stretch=plain, confidence=plain, uncovered=0.0)
