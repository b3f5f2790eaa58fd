"""Views of the artifacts of the shelf `topology`."""

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.input.frame_numbers import take_spans

UNSURE = 0.3
"""Confidence of the up direction below which people are told that it is a guess. Not recorded what it was chosen on."""


@remarks_of(Intervals)
def intervals_remarks(intervals: Intervals) -> tuple[str, ...]:
    """Where the sequence was cut, and by which cues."""
    if not intervals.cues:
        return ("one interval: the topology is the same in all frames",)
    pairs = zip(intervals.end[:-1], intervals.cues, strict=True)
    cuts = [f"{intervals.frames[e]} and {intervals.frames[e + 1]} ({' + '.join(cues)})" for e, cues in pairs]
    return (f"{len(intervals.begin)} intervals, cut between frames {'; '.join(cuts)}",)


@remarks_of(Leaves)
def leaves_remarks(leaves: Leaves) -> tuple[str, ...]:
    """Intervals without leaves, and where leaves that count in an interval were lost or appeared."""
    if not len(leaves.rows):
        return leaf_losses(leaves)
    none = [i for i in range(len(leaves.kept)) if not leaves.kept[i].any()]
    lines = [f"interval {i} has no leaf that is found in enough of its frames" for i in none]
    lines += leaf_losses(leaves)
    begins = [span.start for span in take_spans(leaves.frames)]
    for leaf in range(len(leaves.rows)):
        first = int((leaves.rows[leaf] >= 0).argmax())
        if first not in begins and leaves.kept[:, leaf].any():
            lines.append(f"leaf {leaf} appears first in frame {leaves.frames[first]}")
    return tuple(lines)


def leaf_losses(leaves: Leaves) -> tuple[str, ...]:
    """That there are no leaves at all, or where those that count in an interval were lost."""
    if not len(leaves.rows):
        return ("no leaves found: μ has no clear maximum in any frame, as on a ball, so there are no limbs to follow",)
    gaps = zip(leaves.lost, leaves.lost_begin, leaves.lost_end, strict=True)
    return tuple(
        f"leaf {leaf} was lost from frame {leaves.frames[begin]} to frame {leaves.frames[end]}"
        for leaf, begin, end in gaps
        if leaves.kept[:, leaf].any()
    )


@remarks_of(UpDirection)
def up_direction_remarks(up: UpDirection) -> tuple[str, ...]:
    """Says that the direction is a guess, where it is."""
    if up.confidence >= UNSURE:
        return ()
    guess = f"up direction not certain: pictures show {up.up} as up (confidence {up.confidence:.1f})"
    return (f"{guess}; if it is wrong, set it with --set up_direction.up=…",)
