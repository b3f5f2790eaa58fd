"""Whether a result can be relied on, from what is known of it without a truth (ours)."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints

TRUSTED, UNCERTAIN, WRONG = 0, 1, 2
"""States of a joint in a frame."""


class VerdictSettings(NamedTuple):
    """From which values on something is found. Lengths are shares of the diagonal of the body's box.

    Chosen on recorded and generated people and animals: where the result is right, no part is more than 0.7 % away from
    the input; hands hidden in the body are up to 1.7 %, and a limb that a frame lacks is 14 %.
    """

    uncertain: float = 0.01
    """Root mean square distance between a part and the input above which the part is uncertain in a frame."""
    wrong: float = 0.03
    """The same, above which it is wrong."""
    outside: float = 0.01
    """How far a joint may lie outside the surface."""
    unexplained: float = 0.015
    """Root mean square distance between the skinned mesh and the input, in the median frame, above which nothing is right."""
    confidence: float = 0.5
    """Confidence of a joint below which it is uncertain in a frame; mean confidence below which it is weak."""
    share: float = 0.25
    """Share of frames in which something is wrong above which the whole result is not to be used."""
    frames: int = 5
    """Frames below which a sequence, or the support of a joint, is short."""
    degrees: float = 15.0
    """Range of the angle below which a joint is doubtful: a third of such joints were where the truth has none, of those that
    turn more 6 % (33 and 728 joints of three generated bodies, spoilt in many ways). As a note where its bound is small, three
    of 14 runs that miss a joint would pass as good."""
    length: float = 0.03
    """Length of the bone to its parent below which a joint is doubtful: half of such joints were where the truth has none."""
    expected: float = 0.025
    """Expected error above which a joint is imprecise, share of the longest side of the body's box."""
    bound: float = 0.05
    """The same of the bound that nine joints of ten keep: the distance within which an evaluation calls a joint found."""
    asymmetry: float = 0.04
    """Difference in length between a bone on the left and on the right. Of 384 pairs of generated bodies, spoilt in
    many ways, two differed by more; neither was where the truth has joints. Sound pairs differ by up to 0.038."""


class Evidence(NamedTuple):
    """What is known of a result.

    skin, surface, outside : (frame, joint) as in `surface_error`, share of the diagonal of the body's box
    distance   : (frame,) root mean square distance of the skinned mesh to the input, the same share
    inlier     : (frame,) whether the alignment explains the frame
    confidence : (frame, joint) 0 to 1
    support    : (joint,) frames in which the joint's parts were seen
    degrees    : (joint,) range of its angle
    turning    : (joint,) whether it is a joint: neither root nor end of a bone
    length     : (joint,) of the bone to its parent, share of the diagonal
    expected   : (joint,) expected error, share of the longest side of the body's box; NaN where it is not known
    bound      : (joint,) the distance that the mean error of nine joints of ten keeps, the same share; NaN where not known
    by_shape   : (joint,) whether the body's shape alone shows the joint, so that it turns by nothing
    by_narrowing : (joint,) the same of a narrowing of its limb
    by_mirror  : (joint,) the same of the mirror image of its limb
    pairs      : pairs of joints, left and right, whose bones should be equally long
    unpaired   : joints that have a side, and no partner
    """

    skin: Floats
    surface: Floats
    outside: Floats
    distance: Floats
    inlier: Flags
    confidence: Floats
    support: Ints
    degrees: Floats
    turning: Flags
    length: Floats
    expected: Floats
    bound: Floats
    by_shape: Flags
    by_narrowing: Flags
    by_mirror: Flags
    pairs: Sequence[tuple[int, int]]
    unpaired: Sequence[int]


class Finding(NamedTuple):
    """One thing to know; fields as in the artifact of this name, frames and joints by position."""

    kind: str
    severity: str
    frames: tuple[int, ...] = ()
    joints: tuple[int, ...] = ()
    amount: float = 0.0
    bounds: tuple[float, ...] = ()


class Verdict(NamedTuple):
    """The verdict.

    level    : good, except or unusable
    findings : the most serious first
    state    : (frame, joint) TRUSTED, UNCERTAIN or WRONG
    """

    level: str
    findings: tuple[Finding, ...]
    state: Ints


def verdict(evidence: Evidence, settings: VerdictSettings | None = None) -> Verdict:
    """Finds what speaks against a result, and says whether it can be used.

    A result with a grave finding is unusable; one with a fault is good except for what the fault names.
    """
    s = settings or VerdictSettings()
    state = states(evidence, s)
    findings = (*_of_body(evidence, state, s), *_of_frames(evidence, state, s), *_of_joints(evidence, state, s))
    rank = {"grave": 0, "fault": 1, "note": 2}
    ranked = tuple(sorted(findings, key=lambda found: rank[found.severity]))
    level = {"grave": "unusable", "fault": "except"}.get(ranked[0].severity, "good") if ranked else "good"
    return Verdict(level, ranked, state)


def states(evidence: Evidence, settings: VerdictSettings | None = None) -> Ints:
    """(frame, joint) how far every joint, with its part, is to be trusted in every frame."""
    s = settings or VerdictSettings()
    off = np.maximum(evidence.skin, evidence.surface)
    inner = evidence.turning[None, :] & (evidence.confidence < s.confidence)
    state = np.where((off > s.uncertain) | inner, UNCERTAIN, TRUSTED)
    return np.where((off > s.wrong) | (evidence.outside > s.wrong) & evidence.turning[None, :], WRONG, state)


def sided(anatomy: Sequence[str], parents: Sequence[int]) -> tuple[list[tuple[int, int]], list[int]]:
    """Which joints stand on both sides of the body, and which on one alone.

    anatomy : (joint,) station and side, such as knee_l; empty where nothing is known
    parents : (joint,) −1 for the root
    returns : pairs of joints, left and right, whose parents are the same or a pair as well, so that their bones should be
              equally long; joints with a side whose station the other side does not have
    """
    where = {name: j for j, name in enumerate(anatomy) if name}
    other = {name: f"{name[:-1]}{'r' if name[-1] == 'l' else 'l'}" for name in where if name[-2:] in ("_l", "_r")}

    def above(j: int) -> str:
        return anatomy[parents[j]] if parents[j] >= 0 else ""

    pairs = [(where[name], where[other[name]]) for name in other if name.endswith("_l") and other[name] in where]
    alike = [(a, b) for a, b in pairs if above(a) == above(b) or other.get(above(a)) == above(b)]
    return alike, [where[name] for name in other if other[name] not in where]


def _of_body(e: Evidence, state: Ints, s: VerdictSettings) -> Iterator[Finding]:
    """What is said of the whole result."""
    count = len(e.inlier)
    if not e.turning.any():
        yield Finding("rigid", "grave")
    typical = float(np.median(e.distance)) if count else 0.0
    if typical > s.unexplained:
        yield Finding("unexplained", "grave", amount=typical)
    bad = (state == WRONG).any(axis=1) | ~e.inlier
    if count >= s.frames and bad.mean() > s.share:
        yield Finding("lost", "grave", _at(bad), amount=float(bad.mean()))
    if count < s.frames:
        yield Finding("short", "fault", amount=float(count))
    elif e.turning.any() and e.degrees[e.turning].max() < s.degrees:
        yield Finding("still", "fault", amount=float(e.degrees[e.turning].max()))


def _of_frames(e: Evidence, state: Ints, s: VerdictSettings) -> Iterator[Finding]:
    """What is said of parts of the body in some frames: one finding for all frames in which the same parts are wrong."""
    off = np.maximum(np.maximum(e.skin, e.surface), np.where(e.turning[None, :], e.outside, 0.0))
    groups: dict[tuple[int, ...], list[int]] = {}
    for t in np.flatnonzero((state == WRONG).any(axis=1) | ~e.inlier):
        groups.setdefault(_at(state[t] == WRONG), []).append(int(t))
    worst = sorted(groups.items(), key=lambda item: -float(off[item[1]].max()))
    for joints, frames in worst:
        yield Finding("off", "fault", tuple(frames), joints, float(off[frames].max()))
    out = (e.outside > s.outside) & e.turning[None, :] & (state != WRONG)
    if out.any():
        yield Finding("outside", "fault", _at(out.any(axis=1)), _at(out.any(axis=0)), float(e.outside[out].max()))


def _of_joints(e: Evidence, state: Ints, s: VerdictSettings) -> Iterator[Finding]:
    """What is said of joints in all frames, or in many."""
    mean = e.confidence.mean(axis=0)
    weak = e.turning & ((mean < s.confidence) | (e.support < min(s.frames, len(e.inlier))))
    if weak.any():
        yield Finding("weak", "fault", (), _at(weak), float(mean[weak].min()))
    unsure = (state == UNCERTAIN) & ~weak[None, :]
    groups: dict[tuple[int, ...], list[int]] = {}
    for j in np.flatnonzero(unsure.any(axis=0)):
        groups.setdefault(_at(unsure[:, j]), []).append(int(j))
    for frames, joints in sorted(groups.items(), key=lambda item: -len(item[0])):
        yield Finding("uncertain", "fault", frames, tuple(joints), float(e.confidence[np.ix_(frames, joints)].mean()))
    imprecise = e.turning & ((e.expected > s.expected) | (e.bound > s.bound))
    if imprecise.any():
        worst = np.flatnonzero(imprecise)[np.argsort(-e.bound[imprecise], kind="stable")]
        bounds = tuple(e.bound[worst].tolist())
        yield Finding("imprecise", "fault", (), tuple(worst.tolist()), bounds[0], bounds)
    small = e.turning & (e.degrees < s.degrees)
    close = e.turning & (e.length < s.length) & ~small
    yield from _asymmetric(e, weak | small | close, s)
    is_measured = ~e.by_shape & ~e.by_narrowing & ~e.by_mirror
    little = small & is_measured
    if little.any() and not little[e.turning & is_measured].all():
        yield Finding("small", "fault", (), _at(little), float(e.degrees[little].max()))
    if e.by_shape.any():
        yield Finding("shape", "fault", (), _at(e.by_shape))
    if e.by_narrowing.any():
        yield Finding("narrowing", "note", (), _at(e.by_narrowing))
    if e.by_mirror.any():
        yield Finding("mirror", "note", (), _at(e.by_mirror))
    if close.any():
        yield Finding("close", "fault", (), _at(close), float(e.length[close].min()))
    if e.unpaired:
        yield Finding("unpaired", "note", (), tuple(e.unpaired))


def _asymmetric(e: Evidence, doubtful: Flags, s: VerdictSettings) -> Iterator[Finding]:
    """Pairs of bones of unlike length; a note where one of the joints is doubtful anyway, which is then the reason."""
    for left, right in e.pairs:
        apart = abs(float(e.length[left] - e.length[right]))
        if apart > s.asymmetry:
            yield Finding("asymmetric", "note" if doubtful[[left, right]].any() else "fault", (), (left, right), apart)


def _at(flags: Flags) -> tuple[int, ...]:
    """Positions of the flags that are set."""
    return tuple(np.flatnonzero(flags).tolist())
