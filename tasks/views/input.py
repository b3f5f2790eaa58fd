"""Views of the artifacts of the shelf `input`."""

import math
from itertools import pairwise

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.input.connectivity import Connectivity, Odd
from kinetree.schemas.input.hull import Hull
from kinetree.schemas.input.isosurface import Isosurface
from kinetree.schemas.input.sequence import Sequence
from kinetree.tasks.numerics.input.frame_numbers import take_spans

NAMED_GAPS = 8
"""Most gaps or frames that one sentence names."""


@remarks_of(Sequence)
def sequence_remarks(sequence: Sequence) -> tuple[str, ...]:
    """Names the frames that were left out, those that the numbering leaves out, and those that nothing is learned from."""
    return (*_dropped(sequence), *_missing(sequence), *_further(sequence))


def _further(sequence: Sequence) -> tuple[str, ...]:
    """How many frames are posed alone."""
    if not (more := sequence.further):
        return ()
    learned = sequence.learned
    those = f"frame {more[0]} is" if len(more) == 1 else f"{len(more)} other frames ({more[0]} to {more[-1]}) are"
    return (f"the body is learned from {len(learned)} frames ({learned[0]} to {learned[-1]}); {those} posed by it",)


def _dropped(sequence: Sequence) -> tuple[str, ...]:
    """The frames that were left out, with the reasons."""
    if not (bad := sequence.dropped):
        return ()
    named = "; ".join(f"frame {each.frame}: {each.reason}" for each in bad[:NAMED_GAPS])
    more = f"; and {len(bad) - NAMED_GAPS} more" if len(bad) > NAMED_GAPS else ""
    return (f"{len(bad)} of {len(sequence.frames) + len(bad)} frames were left out of everything: {named}{more}",)


def _gaps(numbers: list[int]) -> list[tuple[int, int]]:
    """First and last number of every gap in one take."""
    steps = [b - a for a, b in pairwise(numbers)]
    step = math.gcd(*steps) or 1
    return [(a + step, b - step) for a, b in pairwise(numbers) if b - a > step]


def _missing(sequence: Sequence) -> tuple[str, ...]:
    """The frames that the numbering leaves out."""
    dropped = {bad.frame for bad in sequence.dropped}
    numbers = sorted({*sequence.frames, *dropped})
    gaps = [gap for span in take_spans(numbers) for gap in _gaps(numbers[span])]
    step = math.gcd(*(b - a for span in take_spans(numbers) for a, b in pairwise(numbers[span]))) or 1
    if not gaps:
        return ()
    count = sum((last - first) // step + 1 for first, last in gaps)
    named = ", ".join(str(first) if first == last else f"{first} to {last}" for first, last in gaps[:NAMED_GAPS])
    more = f" and {len(gaps) - NAMED_GAPS} more gaps" if len(gaps) > NAMED_GAPS else ""
    are = "frame is" if count == 1 else "frames are"
    return (f"{count} {are} missing: {named}{more}; the frames before and after a gap are taken as neighbours",)


@remarks_of(Connectivity)
def connectivity_remarks(connectivity: Connectivity) -> tuple[str, ...]:
    """Says that the connectivity is fixed, or which frames prevent it where only a few do."""
    if connectivity.fixed:
        return (f"fixed connectivity: all frames have the same {connectivity.faces} faces, so nothing has to be aligned",)
    if not connectivity.odd:
        return ()
    first, others = connectivity.odd[0], len(connectivity.odd) - 1
    more = f" (and {others} other frame{'s' * (others > 1)})" if others else ""
    what = f"most frames have the same faces, but frame {first.frame}{more} does not: {_difference(first)}"
    return (f"{what}; all frames are therefore aligned, which is not needed if that frame is corrected or left out",)


@remarks_of(Hull)
def hull_remarks(hull: Hull) -> tuple[str, ...]:
    """Names the views that a frame lacks, and those that cut the body."""
    remarks = []
    if hull.missing:
        remarks.append(
            f"carved with {hull.views} views, without camera {', '.join(hull.missing)}, which has no mask or an empty one;"
            " the body may be thicker here than in other frames"
        )
    if hull.cut:
        remarks.append(
            f"the border of the image cuts the body in {len(hull.cut)} of {hull.views} views ({', '.join(hull.cut)});"
            " they carve nothing beyond it"
        )
    return tuple(remarks)


@remarks_of(Isosurface)
def isosurface_remarks(isosurface: Isosurface) -> tuple[str, ...]:
    """Says that the volume ends before the body does."""
    if not isosurface.cut:
        return ()
    return (f"the body reaches the border of its volume at {isosurface.cut} points and was closed there; give a larger volume",)


def _difference(odd: Odd) -> str:
    """How the frame differs from the others, in words."""
    if odd.inputs:
        return f"its file has {_more_or_fewer(odd.inputs, 'vertex', 'vertices')}"
    if odd.welded > 0:
        if odd.welded == 1:
            return "1 of its vertices lies on another one and was merged with it (mesh.merge)"
        return f"{odd.welded} of its vertices lie on other ones and were merged with them (mesh.merge)"
    if odd.vertices or odd.faces:
        faces = _more_or_fewer(odd.faces, "face", "faces")
        return f"after cleaning it has {_more_or_fewer(odd.vertices, 'vertex', 'vertices')} and {faces}"
    return "its faces join other vertices, or are in another order"


def _more_or_fewer(count: int, one: str, many: str) -> str:
    """A difference in words: 1 vertex more, 3 faces fewer."""
    return f"{abs(count)} {one if abs(count) == 1 else many} {'more' if count >= 0 else 'fewer'}"
