"""What all pictures over time share: seconds where the frame rate is known, and the names that people know."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from kinetree.errors import KinetreeError
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.tasks.results.formats.names import readable_names
from kinetree.tasks.results.plots.drawing import Fetch

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def over_time(axes: "Axes", frames: Sequence[int], fps: float | None, *, both: bool = True, label: bool = True) -> None:
    """Labels an axis of frame numbers: seconds since the first frame below and frames above; frames below without a rate.

    frames : source frame numbers, ascending
    fps    : frames a second; None where it is not known
    both   : whether frames stand above the seconds
    label  : whether the axis has a name
    """
    from matplotlib.ticker import MaxNLocator

    if not fps:
        axes.xaxis.set_major_locator(MaxNLocator(6, integer=True))
        axes.set_xlabel("frame" if label else "")
        return
    ticks = [
        s
        for s in MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(0.0, (frames[-1] - frames[0]) / fps)
        if s * fps <= frames[-1] - frames[0]
    ]
    axes.set_xticks([frames[0] + s * fps for s in ticks], labels=[f"{s:g}" for s in ticks])
    axes.set_xlabel("time, s" if label else "")
    if both:
        above = axes.secondary_xaxis("top")
        above.xaxis.set_major_locator(MaxNLocator(6, integer=True))
        above.tick_params(labelsize=7)
        above.set_xlabel("frame", fontsize=7)


def frame_rate(fetch: Fetch) -> float | None:
    """Frames a second of the sequence; None where it is not known."""
    rate: float | None = fetch("sequence").fps
    return rate


def recognised(fetch: Fetch) -> JointNames | None:
    """The names of joints; None where the run did not come so far."""
    try:
        names: JointNames = fetch("joint_names")
    except KinetreeError:
        return None
    return names


def joint_labels(fetch: Fetch, names: Sequence[str]) -> tuple[str, ...]:
    """What people call each joint; the skeleton's name where nothing was recognised.

    names : (joint,) of the skeleton
    """
    known = recognised(fetch)
    label = dict(zip(known.given, readable_names(known), strict=True)) if known else {}
    return tuple(label.get(name, name) for name in names)
