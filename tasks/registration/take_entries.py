"""The frame by which every take but the reference's is entered."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.registration import take_entries as numerics


@task(among=Sequence)
def take_entries(tips: Mapping[int, Extrema], reference: Reference) -> TakeEntries:
    """Pairs each further take's frame with the frame of a take reached before whose pose is nearest (ours)."""
    frames = tuple(tips)
    limbs = [numerics.Limbs(t.stems, np.array(t.centre), t.size) for t in tips.values()]
    entries = numerics.take_entries(limbs, take_spans(frames), frames.index(reference.frame))
    return TakeEntries(
        frames=tuple(frames[entry.at] for entry in entries),
        before=tuple(frames[entry.before] for entry in entries),
        entry=np.repeat(range(len(entries)), [len(entry.distance) for entry in entries]).astype(np.int32),
        rotation=np.concatenate([np.zeros((0, 3, 3)), *(entry.rotation for entry in entries)]),
        shift=np.concatenate([np.zeros((0, 3)), *(entry.shift for entry in entries)]),
        distance=np.concatenate([np.zeros(0), *(entry.distance for entry in entries)]),
    )
