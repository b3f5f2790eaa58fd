"""What people see of the alignment."""

from itertools import pairwise

import numpy as np

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.array import Bools
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.registration.reference import Reference

LOOP = 0.12
"""Reach of a loop that a limb makes where it touches another; fingers that fuse make shorter ones."""


@remarks_of(Reference)
def reference_remarks(reference: Reference) -> tuple[str, ...]:
    """The frame, and where it could not be a good one."""
    told = [f"reference: frame {reference.frame}"]
    if reference.leaves < 3:
        seen = ("no limb is", "one limb is", "two limbs are")[reference.leaves]
        told.append(f"{seen} seen in any frame: nothing tells contact from freedom, the reference may be a poor one")
    if len(reference.frames) == 2:
        told.append("two frames show one movement: joints that it does not turn cannot be found")
    stay = "limbs that touch in it stay joined"
    if not reference.free:
        told.append(f"no frame is free of contact for long: frame {reference.frame} lacks least; {stay}")
    elif reference.loop >= LOOP:
        told.append(f"frame {reference.frame} has a loop, as a hand on the hip makes one: {stay}")
    return tuple(told)


@remarks_of(FrameConfidence)
def frame_confidence_remarks(confidence: FrameConfidence) -> tuple[str, ...]:
    """Frames that are not trusted, and frames of which a part is not."""
    told = []
    strange, partly = ~confidence.trusted, confidence.trusted & (confidence.doubted > 0.05)
    if strange.any():
        told.append(f"{_runs(confidence, strange)} not trusted: the body does not explain what is seen there")
    if partly.any():
        most = float(confidence.doubted[partly].max())
        told.append(f"{_runs(confidence, partly)} trusted in part: up to {most:.0%} of the body is out of sight or in doubt")
    return tuple(told)


def _runs(confidence: FrameConfidence, flags: Bools) -> str:
    """Frame numbers, runs as first–last, and the verb."""
    at = np.flatnonzero(flags)
    ends = [-1, *(i for i, (a, b) in enumerate(pairwise(at)) if b > a + 1), len(at) - 1]
    spans = [(confidence.frames[at[a + 1]], confidence.frames[at[b]]) for a, b in pairwise(ends)]
    numbers = ", ".join(f"{a}" if a == b else f"{a}–{b}" for a, b in spans)
    return f"frame {numbers} is" if len(at) == 1 else f"frames {numbers} are"
