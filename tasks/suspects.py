"""Frames in which the body may have lost a limb."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.reference import Reference
from kinetree.schemas.suspects import Suspects
from kinetree.schemas.tracking import Tracking
from kinetree.tasks.numerics.repair import suspects as numerics


@task()
def suspects(tracking: Mapping[int, Tracking], reference: Reference) -> Suspects:
    """Finds frames that leave more uncovered than the others, to be tried again from their other side (ours)."""
    frames = tuple(tracking)
    start = frames.index(reference.frame)
    share = np.array([t.uncovered for t in tracking.values()])
    suspect = numerics(share) & (np.arange(len(frames)) != start)
    at = np.arange(len(frames))
    after = np.where(suspect, at + np.sign(at - start), -1)
    return Suspects(
        frames=frames,
        uncovered=share,
        suspect=suspect,
        usual=float(np.delete(share, start).min(initial=1.0)),
        after=np.where(after < len(frames), after, -1),
    )
