"""Joints as TRC (Track Row Column, as OpenSim documents it): a head of six lines, then one line a frame (ours)."""

import numpy as np

from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.markers import markers


def trc(skeleton: Skeleton) -> str:
    """The text of a TRC file of a body in millimetres; a missing frame has its number and time, and no positions."""
    clip = markers(skeleton)
    rows, count = clip.positions.shape[:2]
    rate = f"{clip.rate:.9g}"
    head = [
        "PathFileType\t4\t(X/Y/Z)\tskeleton.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate}\t{rate}\t{rows}\t{count}\tmm\t{rate}\t1\t{rows}",
        "Frame#\tTime\t" + "\t\t\t".join(clip.names) + "\t\t",
        "\t\t" + "\t".join(f"X{j}\tY{j}\tZ{j}" for j in range(1, count + 1)),
        "",
    ]
    lines = [f"{t + 1}\t{t / clip.rate:.6f}\t{_row(clip.positions[t].ravel())}" for t in range(rows)]
    return "\n".join([*head, *lines]) + "\n"


def _row(values: np.ndarray) -> str:
    """Numbers between tabs; nothing for what is missing."""
    return "\t".join("" if np.isnan(x) else f"{x:.6f}" for x in values)
