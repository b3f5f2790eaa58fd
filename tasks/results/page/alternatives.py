"""What the pictures of a report show of this run, in words, for those who do not see them."""

from collections.abc import Mapping, Sequence

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import ArticulatedBody, Skeleton
from kinetree.schemas.topology.correlation import Correlation
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves

NAMED = 3
"""Most joints that are named with a value."""


def skeleton_words(skeleton: Skeleton, frames: Sequence[int]) -> str:
    """Parts and skeleton over the body."""
    rigid = len(np.unique(skeleton.label[skeleton.label >= 0]))
    return f"The body in {_frames(frames)}: {rigid} parts in colours, and over them {_count(skeleton)}."


def tree_words(skeleton: Skeleton, labels: Sequence[str]) -> str:
    """Which joint stands below which, level by level."""
    children = [[labels[k] for k, parent in enumerate(skeleton.parents) if parent == j] for j in range(len(labels))]
    return "; ".join(f"{labels[j]} carries {', '.join(below)}" for j, below in enumerate(children) if below) + "."


def confidence_words(skeleton: Skeleton, labels: Sequence[str]) -> str:
    """The least confident joints with their frames, and the greatest drift."""
    inner = [j for j, kind in enumerate(skeleton.kinds) if kind != "leaf"]
    if not inner:
        return "No joints."
    least = sorted(inner, key=lambda j: float(skeleton.confidence[:, j].min()))[:NAMED]
    weakest = ", ".join(
        f"{labels[j]} {skeleton.confidence[:, j].min():.2f} in frame {skeleton.frames[int(skeleton.confidence[:, j].argmin())]}"
        for j in least
    )
    size = float(np.linalg.norm(np.ptp(skeleton.vertices, axis=0)))
    widest = max(inner, key=lambda j: float(skeleton.drift[j]))
    drift = f"{100 * skeleton.drift[widest] / size:.2g} % of the body's diagonal at {labels[widest]}"
    mean = skeleton.confidence[:, inner].mean()
    return f"Confidence is {mean:.2f} in the mean; least: {weakest}. Parts disagree most, by {drift}."


def angles_words(skeleton: Skeleton, labels: Sequence[str], total: Floats) -> str:
    """Which joints turn most, and when.

    total : (frame, joint) degrees
    """
    turning = [j for j, kind in enumerate(skeleton.kinds) if kind == "joint"]
    if not turning:
        return "No joints."
    most = sorted(turning, key=lambda j: -float(total[:, j].max()))[:NAMED]
    farthest = ", ".join(
        f"{labels[j]} {total[:, j].max():.0f}° in frame {skeleton.frames[int(total[:, j].argmax())]}" for j in most
    )
    least = min(turning, key=lambda j: float(total[:, j].max()))
    return (
        f"Curves of the angles of {len(turning)} joints over {_frames(skeleton.frames)}. Farthest from the reference pose:"
        f" {farthest}; least: {labels[least]} {total[:, least].max():.0f}°."
    )


def correlation_words(series: Correlation, cut: Intervals) -> str:
    """The least correlation and the cuts."""
    values = np.asarray(series.correlation)
    if not len(values):
        return "One frame has no correlation."
    least = int(values.argmin())
    at = f", least {values[least]:.3f} between frames {cut.frames[least]} and {cut.frames[least + 1]}"
    ends = [cut.frames[int(end)] for end in cut.end[:-1]]
    cuts = f"cuts after frames {', '.join(map(str, ends))}" if ends else "no cut"
    return f"C(t) is {values.mean():.3f} in the mean{at}; {cuts}."


def mu_words(leaves: Leaves, frames: Sequence[int]) -> str:
    """How many leaves are seen in each frame drawn."""
    counts = ", ".join(f"{int(np.sum(leaves.is_seen(frame)))} in frame {frame}" for frame in frames)
    return f"The body coloured by μ, dark in its middle and bright at its ends. Leaves that are seen: {counts}."


def alignment_words(skeleton: Skeleton, alignments: Mapping[int, Alignment], reference: int) -> str:
    """The frames that fit worst."""
    size = float(np.linalg.norm(np.ptp(skeleton.vertices, axis=0)))
    worst = {frame: 100 * float(np.quantile(a.residual, 0.95)) / size for frame, a in alignments.items()}
    order = sorted(worst, key=lambda frame: -worst[frame])[:NAMED]
    worst_frames = ", ".join(f"frame {frame} ({worst[frame]:.2g} %)" for frame in order)
    below = "95 % of the vertices are nearer than this share of the body's diagonal, at worst"
    return f"{below}: {worst_frames}. Reference: frame {reference}."


def cones_words(parts: RigidParts) -> str:
    """How many cones there are, and how many annuli each has."""
    annuli = ", ".join(str(int((row >= 0).sum())) for row in parts.run)
    return f"The body from both sides with {len(parts.tip)} cones of {annuli} annuli." if len(parts.tip) else "No cones."


def merging_words(parts: RigidParts) -> str:
    """The highest merge error of every cone, and the threshold."""
    if not len(parts.tip):
        return "No cones."
    highest = ", ".join(f"cone {k} {100 * np.nanmax(row, initial=0.0):.2g} %" for k, row in enumerate(parts.merge))
    return f"Highest merge error: {highest}; the threshold is {100 * parts.merge_threshold:.2g} %."


def elimination_words(parts: RigidParts) -> str:
    """How many parts there were and remained, and how many of these were cut apart."""
    pieces = np.unique(parts.origin, return_counts=True)[1]
    left, apart = len(pieces), int((pieces > 1).sum())
    cut = f" Cut apart of those left: {apart}." if apart else ""
    return f"Of {int(parts.initial.max()) + 1} parts of the first cut {left} are left, {len(parts.removed)} removed.{cut}"


def structure_words(body: ArticulatedBody, tree: KinematicTree) -> str:
    """Parts, borders, and how many of them are joints."""
    parts = f"{len(tree.joint_of_part)} parts with {len(tree.pair)} borders, {len(tree.dropped)} of the parts dropped"
    why = (
        "with which other cuts agree most" if tree.is_given else "with which other cuts, and both sides of the body, agree more"
    )
    cut = "" if tree.cut_frame is None else f" It is of the cut in frame {tree.cut_frame}, {why}."
    return f"The graph of {parts}; beside it the tree with {body.kinds.count('joint')} joints.{cut}"


def lengths_words(body: ArticulatedBody, labels: Sequence[str], variation: Floats) -> str:
    """The bones whose length varies most.

    variation : (joint,) % of the mean
    """
    bones = [j for j, parent in enumerate(body.parents) if parent >= 0 and np.isfinite(variation[j])]
    if not bones:
        return "No bones."
    most = sorted(bones, key=lambda j: -float(variation[j]))[:NAMED]
    return "Lengths vary most at " + ", ".join(f"{labels[j]} ({variation[j]:.2g} %)" for j in most) + "."


def evaluation_words(evaluation: Evaluation) -> str:
    """The joints that are farthest from the true ones, and the missing ones."""
    scored = [joint for joint in evaluation.joints if joint.scored]
    by_error = sorted((j for j in scored if j.percent is not None), key=lambda j: -(j.percent or 0.0))
    farthest = ", ".join(f"{j.name} {j.percent:.2f} %" for j in by_error[:NAMED]) or "none found"
    missing = ", ".join(j.name for j in scored if j.found is None) or "none"
    return f"Errors of {len(by_error)} joints in % of the height; largest: {farthest}. Missing: {missing}."


def _frames(frames: Sequence[int]) -> str:
    if len(frames) <= 2 * NAMED:
        return f"frame{'s' * (len(frames) > 1)} {', '.join(map(str, frames))}"
    return f"{len(frames)} frames, {frames[0]} to {frames[-1]}"


def _count(body: ArticulatedBody) -> str:
    joints, leaves = body.kinds.count("joint"), body.kinds.count("leaf")
    return f"{joints} joint{'s' * (joints != 1)} and {leaves} end{'s' * (leaves != 1)} of bones under one root"
