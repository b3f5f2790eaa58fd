"""Frames in which the body may have lost a limb."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.tracking import Tracking
from kinetree.schemas.registration.tracking_failures import TrackingFailures
from kinetree.tasks.numerics.registration.tracking import suspects as numerics


@task()
def tracking_failures(tracking: Mapping[int, Tracking], reference: Reference) -> TrackingFailures:
    """Finds frames that leave more uncovered than the others, to be tried again from their other side (ours)."""
    frames = tuple(tracking)
    start = frames.index(reference.frame)
    share = np.array([t.uncovered for t in tracking.values()])
    suspect = numerics(share) & (np.arange(len(frames)) != start)
    at = np.arange(len(frames))
    after = np.where(suspect, at + np.sign(at - start), -1)
    return TrackingFailures(
        frames=frames,
        uncovered=share,
        suspect=suspect,
        usual=float(np.delete(share, start).min(initial=1.0)),
        after=np.where(after < len(frames), after, -1),
    )
