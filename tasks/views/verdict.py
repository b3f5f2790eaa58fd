"""The verdict in plain sentences, for the command line, tables and the report."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from kinetree.pipeline.views import remarks_of, summary_of, text_of
from kinetree.schemas.results.verdict import Finding, Level, Verdict

WORDS: dict[Level, str] = {"good": "good", "except": "good except for", "unusable": "do not use"}
"""What a verdict is called."""
NAMED = 6
"""Most joints that a sentence names one by one."""
SHORTLY_NAMED = 3
"""The same in the headline."""
SHORTLY_SPANNED = 2
"""Most stretches of frames that the headline names one by one; of more it counts the frames."""


def headline(verdict: Verdict) -> str:
    """The verdict in one sentence."""
    if verdict.level == "good":
        frames = f"all {len(verdict.frames)} frames"
        return f"good: the skinned mesh follows the input in {frames}, every part to {_percent(verdict.worst)} or better"
    most = verdict.findings[0].severity
    named = [subject(found, verdict) for found in verdict.findings if found.severity == most]
    more = f" and {len(named) - 3} more" if len(named) > 3 else ""
    mark = " " if verdict.level == "except" else ": "
    return f"{WORDS[verdict.level]}{mark}{'; '.join(named[:3])}{more}"


def subject(found: Finding, verdict: Verdict) -> str:
    """What a finding is about, in a few words."""
    where = _frames(found, verdict)
    if len(_spans(found.frames, verdict.frames)) > SHORTLY_SPANNED:
        where = f"{len(found.frames)} of {len(verdict.frames)} frames"
    few = len(found.joints) <= SHORTLY_NAMED
    joints = _joints(found, verdict) if few else f"{len(found.joints)} joints"
    words: dict[str, str] = {
        "rigid": "no joints",
        "unexplained": "the skeleton does not explain the motion",
        "lost": f"wrong in {found.amount:.0%} of the frames",
        "off": f"{joints} in {where}" if joints else where,
        "outside": f"{joints} in {where}",
        "uncertain": f"{joints} in {where}",
        "weak": joints,
        "imprecise": joints,
        "asymmetric": f"the lengths at {joints}",
        "short": f"only {found.amount:.0f} frame{'s' * (found.amount != 1)}",
        "still": "hardly any motion",
        "unpaired": joints,
        "small": joints,
        "shape": joints,
        "narrowing": joints,
        "mirror": joints,
        "close": joints,
    }
    return words[found.kind]


def sentence(found: Finding, verdict: Verdict) -> str:
    """What was found, and what it means."""
    return _SENTENCES[found.kind](found, _joints(found, verdict), _frames(found, verdict))


def _off(found: Finding, joints: str, frames: str) -> str:
    if not joints:
        return f"alignment failed in {frames}: the body does not fit the input there"
    return f"{joints}: wrong in {frames}, {_percent(found.amount)} away from the input"


_SENTENCES: dict[str, Callable[[Finding, str, str], str]] = {
    "rigid": lambda f, joints, frames: "no joints: no part of the body turns against another",
    "unexplained": lambda f, joints, frames: (
        f"the skeleton does not explain the motion: its skin is {_percent(f.amount)} away from the input in most frames;"
        " the body is not rigid there, or joints are missing"
    ),
    "lost": lambda f, joints, frames: f"some part is wrong in {f.amount:.0%} of the frames",
    "off": _off,
    "outside": lambda f, joints, frames: f"{joints}: outside the body in {frames}, by up to {_percent(f.amount)}",
    "uncertain": lambda f, joints, frames: f"{joints}: uncertain in {frames}, hidden or not fitting the input",
    "weak": lambda f, joints, frames: f"{joints}: few frames support it (mean confidence {f.amount:.2f})",
    "imprecise": lambda f, joints, frames: (
        f"{joints}: may be off; nine of ten such joints lie nearer their true place than that share of the body's longest side"
    ),
    "asymmetric": lambda f, joints, frames: f"{joints}: one is misplaced, as their bones differ by {_percent(f.amount)}",
    "short": lambda f, joints, frames: (
        f"only {f.amount:.0f} frame{'s' * (f.amount != 1)}: joints are found by motion, more frames show more of them"
    ),
    "still": lambda f, joints, frames: f"no joint turns by more than {f.amount:.0f}°: where they are is known badly",
    "unpaired": lambda f, joints, frames: f"{joints}: not found on the other side, where it turns too little or was missed",
    "small": lambda f, joints, frames: (
        f"{joints}: turning by at most {f.amount:.0f}°, which may be no joint, or one whose place is known badly"
    ),
    "shape": lambda f, joints, frames: f"{joints}: placed by the body's shape alone, no turn was measured there",
    "narrowing": lambda f, joints, frames: f"{joints}: not found by motion, placed at a narrowing of the limb",
    "mirror": lambda f, joints, frames: f"{joints}: not found by motion, placed where the other side has it",
    "close": lambda f, joints, frames: (
        f"{joints}: only {_percent(f.amount)} from the joint before it, so that the two may be one"
    ),
}


def runs(frames: Sequence[int], among: Sequence[int]) -> str:
    """Frames in words: frame 3, or frames 3–5, 9.

    frames : source frame numbers, ascending
    among  : all frames of the sequence, by which frames are neighbours
    """
    spans = _spans(frames, among)
    shown = ", ".join(f"{a}" if a == b else f"{a}–{b}" for a, b in spans[:NAMED])
    more = f" and {len(spans) - NAMED} more intervals" if len(spans) > NAMED else ""
    return f"frame{'s' * (len(frames) > 1)} {shown}{more}"


def _spans(frames: Sequence[int], among: Sequence[int]) -> list[list[int]]:
    """First and last frame of every stretch of neighbouring frames."""
    place = {frame: t for t, frame in enumerate(among)}
    spans: list[list[int]] = []
    for frame in frames:
        if spans and place[frame] == place[spans[-1][1]] + 1:
            spans[-1][1] = frame
        else:
            spans.append([frame, frame])
    return spans


@remarks_of(Verdict)
def verdict_remarks(verdict: Verdict) -> tuple[str, ...]:
    """The verdict in one sentence, then every fault."""
    return (headline(verdict), *(sentence(found, verdict) for found in verdict.findings if found.severity != "note"))


@summary_of(Verdict)
def verdict_summary(verdict: Verdict) -> Mapping[str, Any]:
    """The verdict and its findings, each with its sentence and its joints as the skeleton and as people call them."""
    label = dict(zip(verdict.joints, verdict.labels, strict=True))
    findings = [
        {
            **found.model_dump(mode="json"),
            "labels": [label[name] for name in found.joints],
            "sentence": sentence(found, verdict),
        }
        for found in verdict.findings
    ]
    return {"level": verdict.level, "headline": headline(verdict), "findings": findings}


@text_of(Verdict)
def verdict_text(verdict: Verdict) -> tuple[str, ...]:
    """The verdict, then what speaks against it, then what is only good to know."""
    marks = {"grave": "✗", "fault": "!", "note": "·"}
    return (headline(verdict), *(f"  {marks[found.severity]} {sentence(found, verdict)}" for found in verdict.findings))


def _frames(found: Finding, verdict: Verdict) -> str:
    return runs(found.frames, verdict.frames) if found.frames else "all frames"


def _joints(found: Finding, verdict: Verdict) -> str:
    label = dict(zip(verdict.joints, verdict.labels, strict=True))
    names = [label[name] for name in found.joints]
    if found.bounds:
        names = [f"{name} (within {100 * bound:.2g} %)" for name, bound in zip(names, found.bounds, strict=True)]
    if found.kind == "asymmetric":
        return " and ".join(names)
    return ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")


def _percent(share: float) -> str:
    """A share of the diagonal of the body's box in words."""
    return f"{100 * share:.2g} % of the body's size"
