"""The whole surface as areas of kinematic cones and cylinders."""

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Bools, Floats
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistency
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.schemas.paper_2014.integration import Integration
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.paper_2014 import cylinders as numerics
from kinetree.tasks.numerics.paper_2014.across_cuts import way
from kinetree.tasks.numerics.paper_2014.annuli import clustered
from kinetree.tasks.numerics.paper_2014.bones import areas
from kinetree.tasks.numerics.paper_2014.integration import integrated
from kinetree.tasks.paper_2014.cone_consistency import cuts_of

Ints = NDArray[np.int64]


@task()
def cylinders(
    middle: tuple[IntervalReference, ...],
    alignment: tuple[Arap, ...],
    consistency: ConeConsistency,
    crossing: CutCorrespondence,
    integration: Integration,
) -> Cylinders:
    """Extends cones into what they leave undefined, again and again, until all of the surface is defined (2014, Sec. 6.2)."""
    home = _fullest(middle, consistency)
    here = middle[home]
    count, F = len(here.vertices), here.faces.astype(np.int64)
    cones = numerics.trimmed(consistency.ring[:, consistency.rows(home)].astype(np.int64), integration.rigid)
    ways = ways_to(home, middle, crossing)
    moving = motions(middle, alignment)
    floors = [integration.floor * m.size for m in middle]
    still = stillness(middle, alignment)

    def cluster(annuli: list[Ints]) -> Bools:
        label = np.full(count, -1)
        for k, mine in enumerate(annuli):
            label[mine] = k
        seen, rigid = [], []
        for x, back, floor, rests in zip(moving, ways, floors, still, strict=True):
            at = np.where(back >= 0, label[back], -1)
            seen.append(np.unique(at[at >= 0]))
            rigid.append(clustered([x[:, at == k] for k in seen[-1]], integration.theta, floor).rigid | rests)
        return integrated(seen, rigid, len(annuli))

    leaf = consistency.leaf[home]
    distance = np.where((leaf >= 0)[:, None], here.distance[leaf], np.nan) if len(leaf) else np.zeros((0, count))
    found = numerics.cylinders(cones, distance, here.area, F, cluster, consistency.annuli)
    annulus = np.full(count, -1)
    for piece in (*cones, *found):
        annulus = np.where(piece.ring >= 0, piece.ring, annulus)
    whole = areas([*cones, *found], count, F)
    return Cylinders(interval=home, cones=len(cones), annulus=annulus, **whole._asdict())


def ways_to(home: int, middle: tuple[IntervalReference, ...], crossing: CutCorrespondence) -> list[Ints]:
    """Of every interval, the vertex of the home interval's reference at each of its own."""
    cuts = cuts_of(crossing)
    onward, backward = [c.onward for c in cuts], [c.backward for c in cuts]
    return [way(onward, backward, i, home, len(m.vertices)) for i, m in enumerate(middle)]


def motions(middle: tuple[IntervalReference, ...], alignment: tuple[Arap, ...]) -> list[Floats]:
    """Of every interval, (frame, vertex, xyz) its reference in all of its frames."""
    end = np.cumsum([len(m.frames) for m in middle])
    return [np.stack([a.vertices for a in alignment[e - len(m.frames) : e]]) for m, e in zip(middle, end, strict=True)]


def stillness(middle: tuple[IntervalReference, ...], alignment: tuple[Arap, ...]) -> list[bool]:
    """Of every interval, whether nothing on the body moves against anything else in it."""
    end = np.cumsum([len(m.frames) for m in middle])
    return [all(a.still for a in alignment[e - len(m.frames) : e]) for m, e in zip(middle, end, strict=True)]


def _fullest(middle: tuple[IntervalReference, ...], consistency: ConeConsistency) -> int:
    """The interval in which most cones are seen, of these the longest, of these the first."""
    seen = (consistency.leaf >= 0).sum(axis=1)
    return max(range(len(middle)), key=lambda i: (seen[i], len(middle[i].frames), -i))
