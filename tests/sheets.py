"""A sheet that folds from frame to frame, its vertices numbered anew in each: every vertex's way is known exactly.

Distances over the surface never change, so that geodesic coordinates map each vertex onto itself.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapes import flat_grid, folded

from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.paper_2014.geodesic_coordinates import GeodesicCoordinates
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.paper_2014.geodesic_coordinates import geodesic_coordinates

SHEET, FACES = flat_grid(14, 9)
CORNERS = np.array([0, 8, 13 * 9])
CHANGING = Connectivity(fixed=False, first_change=1, vertices=len(SHEET), faces=len(FACES))
TRACKED = Connectivity(fixed=True, first_change=None, vertices=len(SHEET), faces=len(FACES))


@dataclass(frozen=True)
class Frame:
    """One frame, and where among its vertices each of the sheet's is."""

    mesh: Mesh
    tips: Extrema
    geodesics: Geodesics
    coordinates: GeodesicCoordinates
    place: NDArray[np.int64]


def frame(number: int, *, hidden: tuple[int, ...] = (), bend: float = 0.15, anew: bool = True) -> Frame:
    """The sheet in a frame; of its three leaves some may be hidden, the others stand in another order in each frame."""
    V = folded(SHEET, 6.0, bend * number)
    order = np.random.default_rng(number).permutation(len(V)) if anew else np.arange(len(V))
    place = np.argsort(order)
    mesh = Mesh(
        vertices=V[order], faces=place[FACES].astype(np.int32), vertex_of_input=np.arange(len(V)), cleaning=Cleaning()
    )
    seen = np.array([n for n in np.roll([0, 1, 2], number) if n not in hidden], np.int64)
    tip = place[CORNERS[seen]]
    X = V[CORNERS[seen]]
    tips = Extrema(
        vertices=tip, persistence=np.full(len(tip), 0.5), stems=np.stack([0 * X, X], axis=1),
        normals=np.tile([0.0, 0.0, 1.0], (len(tip), 1)), value=np.full(len(tip), 0.7), peaks=np.full(len(tip), 0.5),
        loops=np.zeros(0), size=10.0, centre=(0.0, 0.0, 0.0), euler=1, components=1,
    )  # fmt: skip
    area = np.full(len(V), 13 * 8 / len(V))
    geodesics = Geodesics(mu=np.ones(len(V)), area=area, bases=np.zeros(0, np.int64), share=1.0)
    return Frame(mesh, tips, geodesics, geodesic_coordinates(mesh, tips), place)


def followed(frames: dict[int, Frame], *ends: int) -> tuple[Intervals, Leaves]:
    """Intervals that end at these positions, and the leaves as they are seen: leaf n is corner n."""
    count = len(frames)
    rows, positions = np.full((3, count), -1), np.full((3, count, 3), np.nan)
    for t, here in enumerate(frames.values()):
        for leaf in range(3):
            row = np.flatnonzero(here.tips.vertices == here.place[CORNERS[leaf]])
            if len(row):
                rows[leaf, t], positions[leaf, t] = row[0], here.tips.stems[row[0], -1]
    begin = [0, *(e + 1 for e in ends[:-1])]
    kept = np.array([(rows[:, a : b + 1] >= 0).mean(axis=1) >= 0.5 for a, b in zip(begin, ends, strict=True)])
    none = np.zeros(0, np.int64)
    intervals = Intervals(
        frames=tuple(frames), begin=np.array(begin), end=np.array(ends), z=np.zeros(count - 1),
        cues=(("leaves",),) * (len(ends) - 1), strengths=np.zeros((1, count - 1)), cue_names=("leaves",), threshold=2.0,
    )  # fmt: skip
    return intervals, Leaves(
        frames=tuple(frames), rows=rows, positions=positions, kept=kept, lost=none, lost_begin=none, lost_end=none
    )


def exact(place: NDArray[np.int64], here: Frame) -> Alignment:
    """The sheet in a frame, its vertices numbered as in the reference of which `place` is told."""
    x = np.empty_like(here.mesh.vertices)
    x[place] = here.mesh.vertices[here.place]
    plain = np.ones(len(x))
    return Alignment(vertices=x, residual=0 * plain, stretch=plain, trust=plain, uncovered=0.0)
