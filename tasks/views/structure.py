"""Views of the artifacts of the shelf `structure`."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from kinetree.pipeline.views import remarks_of, text_of
from kinetree.schemas.results.assumed_joints import AssumedJoint, AssumedJoints
from kinetree.schemas.results.verdict import Verdict
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.joint_names import CERTAIN_FRONT, JointNames
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.views.verdict import headline

if TYPE_CHECKING:
    from kinetree.tasks.numerics.structure.anatomical_names import Named


STILL = {"shape": "by the shape alone", "narrowing": "by a narrowing of the limb alone", "mirror": "by the other side alone"}
"""In words how joints are known at which no turn was measured."""
NAMED_ONE_BY_ONE = 5
"""Joints to rename that are not called as it was set, of each kind."""


@remarks_of(KinematicTree)
def kinematic_tree_remarks(tree: KinematicTree) -> tuple[str, ...]:
    """None: the skeleton says it."""
    return ()


@remarks_of(Skeleton)
def skeleton_remarks(skeleton: Skeleton) -> tuple[str, ...]:
    """How many joints there are, or why there are none."""
    turning = skeleton.kinds.count("joint")
    if not turning:
        return ("no joints found: no part of the body turns against another, so the body is one rigid part",)
    leaves = skeleton.kinds.count("leaf")
    return (f"{turning} joint{'s' * (turning != 1)} and {leaves} lea{'f' if leaves == 1 else 'ves'} under {skeleton.names[0]}",)


@text_of(Skeleton, JointNames, Verdict, AssumedJoints, ErrorBars)
def skeleton_text(
    skeleton: Skeleton,
    joint_names: JointNames | None,
    verdict: Verdict | None,
    assumed: AssumedJoints | None = None,
    bars: ErrorBars | None = None,
) -> tuple[str, ...]:
    """The tree, one line a joint: length of its bone, range of its angle, expected error, frames that support it.

    The error is followed by the bound that nine of ten joints keep, and how far off the frames' surfaces have the joint; where
    no error is known, the drift stands for it.

    Above it the verdict; joints as people call them, with the skeleton's own name where that is another. Below it joints that
    are assumed.
    """
    from kinetree.tasks.results.formats.names import readable_names  # its shelf imports all that computes

    known = dict(zip(joint_names.given, readable_names(joint_names), strict=True)) if joint_names else {}
    labels = [f"{known[n]} ({n})" if known.get(n, n) != n else n for n in skeleton.names]
    names = [f"{_branch(skeleton, joint)}{label}" for joint, label in enumerate(labels)]
    width = max(map(len, names))
    above = (headline(verdict), "") if verdict else ()
    tree = (f"{name:{width}}  {_measures(skeleton, joint, bars)}".rstrip() for joint, name in enumerate(names))
    return (*above, *tree, *(assumed_words(joint, labels, skeleton.parents) for joint in (assumed.joints if assumed else ())))


def assumed_words(joint: AssumedJoint, labels: Sequence[str], parents: Sequence[int]) -> str:
    """Where a joint is assumed, in words.

    labels  : (joint,) what people call the joints that were found
    parents : (joint,)
    """
    from kinetree.tasks.results.formats.names import in_words

    known = in_words(joint.anatomy)
    bone = f"{labels[parents[joint.child]]} to {labels[joint.child]}"
    why = "as on the other side" if joint.source == "mirror" else "by usual proportions"
    return f"assumed, not found: {known}, at {100 * joint.share:.0f} % of the bone from {bone}, {why}"


def _branch(skeleton: Skeleton, joint: int) -> str:
    """The lines that connect a joint with its parent, as a tree of folders is printed."""
    parent, lead = skeleton.parents[joint], ""
    while parent >= 0:
        is_last = joint == max(j for j, p in enumerate(skeleton.parents) if p == parent)
        mark = ("└─ " if is_last else "├─ ") if not lead else ("   " if is_last else "│  ")
        joint, parent, lead = parent, skeleton.parents[parent], mark + lead
    return lead


def _measures(skeleton: Skeleton, joint: int, bars: ErrorBars | None) -> str:
    """What is measured of a joint, in words."""
    if skeleton.kinds[joint] == "root":
        return f"root, {len(skeleton.frames)} frames"
    unit = f" {skeleton.unit}" if skeleton.unit else ""
    length = f"bone {skeleton.lengths[joint]:.4g}{unit}"
    if skeleton.kinds[joint] == "leaf":
        return length
    support = f"supported by {skeleton.support[joint]} of {len(skeleton.frames)} frames"
    off = f"±{skeleton.drift[joint]:.2g}{unit}"
    if bars is not None and bars.cuts:
        off = f"±{two_digits(bars.expected[joint])}{unit} (90 %: {two_digits(bars.bound[joint])})"
        if np.isfinite(bars.surface_offset[joint]):
            off += f", surface offset {two_digits(bars.surface_offset[joint])}{unit}"
    still = None if bars is None else STILL.get(bars.evidence[joint] or "")
    turn = f"turns {skeleton.degrees[joint]:.0f}°" if still is None or skeleton.degrees[joint] >= 0.5 else "no turn measured"
    turn = turn if still is None else f"{still}, {turn}"
    return f"{length}, {turn}, {off}, {support}"


def two_digits(length: float) -> str:
    """A length with two digits and without an exponent where that is short."""
    return f"{float(f'{length:.2g}'):g}"


@remarks_of(ErrorBars)
def error_bars_remarks(bars: ErrorBars) -> tuple[str, ...]:
    """The joints' errors in one sentence."""
    known = np.array(bars.expected)[np.isfinite(bars.expected)]
    if not len(known):
        return ()
    cuts = f"{bars.cuts} cuts" if bars.cuts > 1 else "one cut"
    return (f"joints are expected to be off by {two_digits(np.median(known))}, at most {two_digits(known.max())} ({cuts})",)


@text_of(ErrorBars)
def error_bars_text(bars: ErrorBars) -> tuple[str, ...]:
    """One line a joint: its expected error, the bound, and the evidence."""
    rows = [j for j in range(len(bars.joints)) if np.isfinite(bars.expected[j])]
    if not rows:
        return ("no errors are known",)
    wide = max(len(bars.joints[j]) for j in rows)
    lengths = ("expected", "bound", "drift", "spread", "residual", "surface_offset", "asymmetry")
    lines = []
    for j in rows:
        expected, bound, drift, spread, residual, offset, unlike = (two_digits(getattr(bars, name)[j]) for name in lengths)
        evidence = f"drift {drift}, spread {spread} over {bars.agreeing[j]} of {bars.cuts} cuts, residual {residual}"
        evidence += "" if np.isnan(bars.surface_offset[j]) else f", surface offset {offset}"
        evidence += "" if np.isnan(bars.asymmetry[j]) else f", bone {unlike} unlike its mirror image"
        evidence = STILL.get(bars.evidence[j] or "", evidence)
        support = f"seen in {bars.support[j]} frames"
        lines.append(f"{bars.joints[j]:{wide}}  ±{expected}, 90 % below {bound}; {evidence}, {support}")
    return tuple(lines)


@remarks_of(JointNames)
def joint_names_remarks(names: JointNames) -> tuple[str, ...]:
    """What the body was recognised as, whether left and right may be exchanged, and what became of joints to rename."""
    return (*_recognised(names), *renaming_remarks("joint_names.rename", names))


def renaming_remarks(where: str, names: JointNames, formats: Sequence[str] | None = None) -> tuple[str, ...]:
    """Joints to rename that were not found under any of their names, or are called otherwise; none where all is as it was set.

    where   : what says that they are renamed
    formats : of the files that are written; None for all
    """
    from kinetree.tasks.results.formats.names import IDENTIFIER_FORMATS, identifiers  # its shelf imports all that computes

    rename = names.spelling.rename
    if not rename:
        return ()
    known = {*names.given, *_unnumbered(names, {})}
    unknown = [joint for joint in rename if joint not in known]
    wanted = _unnumbered(names, rename)
    taken = [f"{w} is {name}" for w, name in zip(wanted, names.names, strict=True) if w in rename.values() and w != name]
    plain = [(name, text) for name, text in zip(names.names, identifiers(names.names), strict=True) if name != text]
    unheld = [f"{name!r} is {text}" for name, text in plain if name in rename.values()]
    plain_in = [form for form in IDENTIFIER_FORMATS if formats is None or form in formats]
    told = {
        "no joint that was found is called ": unknown,
        "a name that another joint has gets a number: ": taken,
        f"names in {', '.join(plain_in)} are of a-z, A-Z, 0-9 and _: ": unheld if plain_in else [],
    }
    return tuple(f"{where}: {what}{_some(joints)}" for what, joints in told.items() if joints)


def _unnumbered(names: JointNames, rename: Mapping[str, str]) -> list[str]:
    """(joint,) what each joint would be called if it were alone."""
    from kinetree.tasks.numerics.structure.name_styles import styled_names

    style, sides = names.spelling.style, names.spelling.side_suffixes
    own = zip(names.given, names.anatomy, strict=True)
    return [styled_names([_station(anatomy)], [name], style, sides, rename)[0] for name, anatomy in own]


def _some(texts: Sequence[str]) -> str:
    """The first of the texts, and how many more there are."""
    more = f" and {len(texts) - NAMED_ONE_BY_ONE} more" if len(texts) > NAMED_ONE_BY_ONE else ""
    return f"{', '.join(texts[:NAMED_ONE_BY_ONE])}{more}"


def _station(anatomy: str) -> "Named | None":
    """What a joint is, from its text; None where that is empty."""
    from kinetree.tasks.numerics.structure.anatomical_names import Named

    station, _, side = anatomy.rpartition("_")
    return (Named(station, side) if station and side in ("l", "r") else Named(anatomy)) if anatomy else None


def _recognised(names: JointNames) -> tuple[str, ...]:
    if names.topology == "unknown":
        return ()
    what = "a person" if names.topology == "human" else "a four-legged animal"
    lines = [f"recognised as {what} (confidence {names.confidence:.1f})"]
    if names.front_confidence < CERTAIN_FRONT:
        lines.append(
            "left and right may be exchanged: neither feet, knees nor travel say for certain which way the body faces"
            f" (confidence {names.front_confidence:.1f}); set joint_names.front to the direction that it faces"
        )
    return tuple(lines)


@text_of(JointNames)
def joint_names_text(names: JointNames) -> tuple[str, ...]:
    """One line a joint: the skeleton's name, the name in files, and what the joint is."""
    wide = [max(map(len, column)) for column in (names.given, names.names)]
    rows = zip(names.given, names.names, names.anatomy, strict=True)
    return tuple(f"{own:{wide[0]}}  {name:{wide[1]}}  {anatomy or '–'}" for own, name, anatomy in rows)
