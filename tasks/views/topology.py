"""What people see of the body's topology."""

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection

UNSURE = 0.3
"""Below this confidence the way up is a guess worth a word."""


@remarks_of(Intervals)
def intervals_remarks(intervals: Intervals) -> tuple[str, ...]:
    """Where the sequence was cut, and by what."""
    if not intervals.cues:
        return ("one interval: the topology stays the same in all frames",)
    made = zip(intervals.end[:-1], intervals.cues, strict=True)
    cuts = [f"{intervals.frames[e]}|{intervals.frames[e + 1]} ({' + '.join(cues)})" for e, cues in made]
    return (f"{len(intervals.begin)} intervals, cut at frames {', '.join(cuts)}",)


@remarks_of(Leaves)
def leaves_remarks(leaves: Leaves) -> tuple[str, ...]:
    """No leaves at all, intervals without any, and where leaves that count in some interval were lost or appeared."""
    if not len(leaves.rows):
        return ("no leaves: no frame has a tip that stands out of the body, as on a ball; there are no limbs to follow",)
    told = [f"interval {i} has no leaf that is seen often enough" for i in range(len(leaves.kept)) if not leaves.kept[i].any()]
    for leaf, begin, end in zip(leaves.lost, leaves.lost_begin, leaves.lost_end, strict=True):
        if leaves.kept[:, leaf].any():
            told.append(f"leaf {leaf} is not seen from frame {leaves.frames[begin]} to {leaves.frames[end]}")
    for leaf in range(len(leaves.rows)):
        first = int((leaves.rows[leaf] >= 0).argmax())
        if first > 0 and leaves.kept[:, leaf].any():
            told.append(f"leaf {leaf} is first seen in frame {leaves.frames[first]}")
    return tuple(told)


@remarks_of(UpDirection)
def up_direction_remarks(up: UpDirection) -> tuple[str, ...]:
    """Said where it is hardly more than a guess."""
    if up.confidence >= UNSURE:
        return ()
    guess = f"pictures have {up.up} up, which is a guess (confidence {up.confidence:.1f})"
    return (f"{guess}; --set up_direction.up=… says it",)
