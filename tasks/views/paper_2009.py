"""Views of the artifacts of the shelf `paper_2009`."""

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervals
from kinetree.schemas.paper_2009.contact_kinds import ContactKinds
from kinetree.schemas.paper_2009.initial_frames import InitialFrames

KINDS = {1: "end to end", 2: "end to side", 3: "side to side"}
"""The paper's types of contact, in words."""


@remarks_of(CoherentIntervals)
def coherent_intervals_remarks(runs: CoherentIntervals) -> tuple[str, ...]:
    """How many frames are coherent, and in which intervals."""
    spans = [f"{runs.frames[a]} to {runs.frames[b]}" for a, b in zip(runs.begin, runs.end, strict=True)]
    counts = f"{int(runs.coherent.sum())} of {len(runs.frames)} frames are topologically coherent, with {runs.wanted_ends} ends"
    return (f"{counts}: {'; '.join(spans)}" if spans else f"{counts}; no interval is long enough",)


@remarks_of(InitialFrames)
def initial_frames_remarks(initial: InitialFrames) -> tuple[str, ...]:
    """The initial frames, and that they are a substitute where no interval is coherent."""
    at = ", ".join(str(initial.frames[t]) for t in initial.initial)
    if initial.coherent:
        return (f"initial frame{'s' * (len(initial.initial) > 1)}: {at}",)
    return (f"no topologically coherent interval: the initial model is of frame {at}, with the most ends and the fewest loops",)


@remarks_of(ContactKinds)
def contact_kinds_remarks(contacts: ContactKinds) -> tuple[str, ...]:
    """Which branches touch, how and how long."""
    lines = []
    pairs = sorted({(int(a), int(b), int(k)) for a, b, k in zip(contacts.branch, contacts.other, contacts.kind, strict=True)})
    for a, b, kind in pairs:
        own = contacts.frame[(contacts.branch == a) & (contacts.other == b) & (contacts.kind == kind)]
        first = "the trunk" if a < 0 else f"branch {a}"
        times = f"{len(own)} frame{'s' * (len(own) != 1)}"
        lines.append(f"{first} and branch {b} touch {KINDS[kind]} in {times}, first in {own[0]}")
    return tuple(lines)
