"""The order in which frames are reached from the reference."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.tracking_order import TrackingOrder
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.registration import tracking_order as numerics


@task()
def tracking_order(reference: Reference, take_entries: TakeEntries, sequence: Sequence) -> TrackingOrder:
    """Orders the frames outwards from the reference; frames that nothing is learned from hang on to that tree (ours)."""
    frames = sequence.frames
    learned = np.isin(frames, reference.frames)
    roots = {frames.index(reference.frame): -1}
    roots |= {frames.index(t): frames.index(b) for t, b in zip(take_entries.frames, take_entries.before, strict=True)}
    before = numerics.takes_order(learned, take_spans(frames), roots)
    return TrackingOrder(frames=frames, before=np.full(len(frames), -1) if reference.fixed else before)
