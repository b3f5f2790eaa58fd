"""The order in which frames are reached from the reference."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.tracking_order import TrackingOrder
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.registration import tracking_order as numerics
from kinetree.tasks.registration.reference import followed_stems


@task(among=Sequence)
def tracking_order(
    reference: Reference, take_entries: TakeEntries, sequence: Sequence, tips: Mapping[int, Extrema], leaves: Leaves
) -> TrackingOrder:
    """Orders the frames outwards from the reference, by few steps; further frames hang on to that tree (ours)."""
    frames = sequence.frames
    if reference.fixed:
        return TrackingOrder(frames=frames, before=np.full(len(frames), -1))
    learned = np.isin(frames, reference.frames)
    roots = {frames.index(reference.frame): -1}
    roots |= {frames.index(t): frames.index(b) for t, b in zip(take_entries.frames, take_entries.before, strict=True)}
    moved = numerics.limb_motion(followed_stems(leaves, tuple(tips.values())), reference.size)
    return TrackingOrder(frames=frames, before=numerics.takes_order(learned, take_spans(frames), roots, moved))
