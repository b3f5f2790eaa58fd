"""Steps of a walking body from its joints alone, on the ground or on a treadmill (Zeni, Richards, Higginson 2008).

A foot strikes where it is farthest ahead of the pelvis, and leaves the ground where it is farthest behind.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


class GaitSettings(NamedTuple):
    """What counts as walking; chosen on no recording, and not varied so far."""

    reach: float = 0.3
    """Least way of a foot from behind to ahead, share of the leg's length; feet that stand and wave stay below."""
    prominence: float = 0.5
    """Share of that way by which a turning point stands out, so that a tremor is no step."""


class Event(NamedTuple):
    """foot : which of the feet · kind : strike or off · sample : between two samples, as a fraction · time : seconds"""

    foot: int
    kind: str
    sample: float
    time: float


def gait_events(
    heels: Floats,
    toes: Floats,
    pelvis: Floats,
    ahead: Floats,
    legs: Sequence[float],
    times: Floats,
    settings: GaitSettings | None = None,
) -> list[Event]:
    """Foot strikes and toe-offs in order of time; none where a foot does not swing, or turns round fewer than three times.

    heels, toes : (frame, foot, xyz), any unit
    pelvis      : (frame, xyz)
    ahead       : (frame, xyz) horizontal unit vectors that the body faces
    legs        : (foot,) length of each leg
    times       : (frame,) seconds, ascending
    """
    s = settings or GaitSettings()
    events: list[Event] = []
    for foot, leg in enumerate(legs):
        strikes, offs = (
            _turning(sign * np.sum((X[:, foot] - pelvis) * ahead, axis=1), s.reach * leg, s.prominence)
            for sign, X in ((1.0, heels), (-1.0, toes))
        )
        if len(strikes) + len(offs) < 3:
            return []
        for kind, samples in (("strike", strikes), ("off", offs)):
            events += [Event(foot, kind, k, float(np.interp(k, np.arange(len(times)), times))) for k in samples]
    return sorted(events, key=lambda event: event.time)


def strides(events: Sequence[Event], foot: int) -> tuple[Floats, Floats]:
    """Seconds of each stride of a foot, from strike to strike · seconds of its stance, from strike to the off within it."""
    strikes = [e.time for e in events if e.foot == foot and e.kind == "strike"]
    offs = [e.time for e in events if e.foot == foot and e.kind == "off"]
    stances = [next((o - a for o in offs if a < o < b), np.nan) for a, b in pairwise(strikes)]
    return np.diff(strikes), np.array(stances)


def symmetry_index(left: float, right: float) -> float:
    """Difference of right and left, % of their mean; 0 for equal ones  (Robinson, Herzog, Nigg 1987)."""
    return 200.0 * (right - left) / (right + left)


def _turning(way: Floats, reach: float, prominence: float) -> list[float]:
    """Samples at which a way is largest, between samples by a parabola through three."""
    span = float(np.ptp(way))
    if span < reach:
        return []
    from scipy.signal import find_peaks  # takes as long to import as all else of scipy

    peaks, _ = find_peaks(way, prominence=prominence * span)
    before, at, after = way[peaks - 1], way[peaks], way[peaks + 1]
    bend = before - 2.0 * at + after
    shift = np.where(bend < 0, 0.5 * (before - after) / np.where(bend < 0, bend, 1.0), 0.0)
    return [float(x) for x in peaks + shift]
