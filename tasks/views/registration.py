"""Views of the artifacts of the shelf `registration`."""

from itertools import pairwise

import numpy as np

from kinetree.pipeline.views import remarks_of
from kinetree.schemas.array import Bools
from kinetree.schemas.registration.colour_agreement import ColourAgreement
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.registration.reference import Reference

CONTACT_LOOP = 0.12
"""Least reach of a loop that counts as contact of limbs, share of the range of μ; fused fingers make shorter loops. Not
recorded what it was chosen on; a smaller value warns of more references."""
PARTLY_DOUBTED = 0.05
"""Share of the body's vertices in doubt above which a frame is mentioned. Not recorded what it was chosen on."""


@remarks_of(Reference)
def reference_remarks(reference: Reference) -> tuple[str, ...]:
    """The reference frame, and why it may be a bad one."""
    lines = [f"reference: frame {reference.frame}"]
    if reference.leaves < 3:
        limbs = ("no limb", "only one limb", "only two limbs")[reference.leaves]
        lines.append(f"{limbs} found in any frame; contact cannot be recognised, so the reference may contain one")
    if len(reference.frames) == 2:
        lines.append("only two frames; joints that do not turn between them cannot be found")
    joined = "parts that touch in it stay joined"
    if not reference.free:
        lines.append(f"no contact-free frame; frame {reference.frame} is the best available, but {joined}")
    elif reference.loop >= CONTACT_LOOP:
        lines.append(f"the surface of frame {reference.frame} has a loop, such as a hand on the hip makes; {joined}")
    return tuple(lines)


@remarks_of(ColourAgreement)
def colour_agreement_remarks(agreement: ColourAgreement) -> tuple[str, ...]:
    """Whether colours hold the alignment; nothing where there are none."""
    if not agreement.frames:
        return ()
    share = f"those of the reference explain {np.median(agreement.share):.0%} of a frame's in the median"
    if agreement.is_used:
        return (f"colours of the frames agree and hold the alignment: {share}",)
    return (f"colours of the frames do not agree and are not used: {share}",)


@remarks_of(FrameConfidence)
def frame_confidence_remarks(confidence: FrameConfidence) -> tuple[str, ...]:
    """Frames whose alignment failed, and frames in which parts of it are unreliable."""
    lines = []
    failed, partly = ~confidence.inlier, confidence.inlier & (confidence.unreliable > PARTLY_DOUBTED)
    if failed.any():
        lines.append(f"alignment failed in {_runs(confidence, failed)}: the aligned body does not fit the mesh there")
    if partly.any():
        most = float(confidence.unreliable[partly].max())
        where = _runs(confidence, partly)
        lines.append(f"alignment partly unreliable in {where}: up to {most:.0%} of the body is hidden or does not fit")
    return tuple(lines)


def _runs(confidence: FrameConfidence, flags: Bools) -> str:
    """The frames of the flags in words: frame 3, or frames 3–5, 9."""
    at = np.flatnonzero(flags)
    ends = [-1, *(i for i, (a, b) in enumerate(pairwise(at)) if b > a + 1), len(at) - 1]
    spans = [(confidence.frames[at[a + 1]], confidence.frames[at[b]]) for a, b in pairwise(ends)]
    numbers = ", ".join(f"{a}" if a == b else f"{a}–{b}" for a, b in spans)
    return f"frame{'s' * (len(at) > 1)} {numbers}"
