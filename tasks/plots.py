"""Pictures for people: μ on the body with its leaves, C(t) with the cuts (2014, Fig. 5)."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.errors import ConfigError
from kinetree.schemas.array import Artifact, Floats, Ints

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Fetch = Callable[..., Any]
"""Gives the artifact of a task at an index, as `Pipeline.artifact` does."""
FORMATS = (".png", ".svg", ".pdf")
BEHIND = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.8}
LEAF_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442")
"""Okabe and Ito's eight, which the colour-blind can tell apart."""


def correlation(fetch: Fetch, frames: list[int], up: int | None = None) -> "Figure":
    """C(t) with the cuts and what made them, intervals shaded in turn (2014, Fig. 5); below, how near each cue came."""
    series, cut = fetch("correlation"), fetch("intervals")
    figure, (axes, below) = _figure(9.0, 6.0, rows=2)
    t = np.array(cut.frames)
    between = (t[:-1] + t[1:]) / 2
    for row, name in enumerate(cut.cue_names):
        below.plot(between, cut.strengths[row], label=name, color=LEAF_COLOURS[row], lw=1, ls=("-", "--", "-.", ":")[row % 4])
    below.axhline(1.0, color="black", lw=0.6)
    below.set(xlabel="frame", ylabel="cue / its threshold", xlim=(t[0] - 0.5, t[-1] + 0.5), ylim=(0, None))
    below.legend(fontsize=7, ncols=len(cut.cue_names))
    for number, (begin, end) in enumerate(zip(cut.begin, cut.end, strict=True)):
        axes.axvspan(t[begin] - 0.5, t[end] + 0.5, color="#0072B2" if number % 2 else "#E69F00", alpha=0.12, lw=0)
    axes.plot(between, series.correlation, color="black", marker=".", lw=1)
    for end, cues in zip(cut.end[:-1], cut.cues, strict=True):
        axes.axvline(t[end] + 0.5, color="#D55E00", lw=1)
        axes.annotate(" + ".join(cues), (t[end] + 0.7, 0.5), xycoords=("data", "axes fraction"), fontsize=7)
    axes.set(ylabel="C(t)", xlim=(t[0] - 0.5, t[-1] + 0.5))
    count = len(cut.begin)
    axes.set_title(f"Correlation of μ histograms; {count} interval{'s' if count > 1 else ''}")
    return figure


def mu(fetch: Fetch, frames: list[int], up: int | None = None) -> "Figure":
    """μ on the surface with the tips of the extremities, one view a frame; a leaf keeps its colour."""
    followed = fetch("leaves")
    figure, row = _figure(3.2 * len(frames), 4.2, len(frames))
    view = _view([fetch("mesh", frame=frame).vertices for frame in frames], up)
    for axes, frame in zip(np.atleast_1d(row), frames, strict=True):
        mesh, found = fetch("mesh", frame=frame), fetch("geodesics", frame=frame)
        _surface(axes, mesh.vertices @ view, mesh.faces, found.mu)
        _leaves(axes, followed, frame, view)
        axes.set_title(f"frame {frame}", fontsize=9)
    return figure


WHAT: Mapping[str, Callable[[Fetch, list[int], int | None], "Figure"]] = {"correlation": correlation, "mu": mu}
"""What can be drawn, by the word of the command line."""


def draw(what: str, fetch: Fetch, frames: list[int], path: Path, up: int | None = None) -> None:
    """Draws into a file, complete or not at all.

    up     : axis of the coordinates that points up; None guesses it
    raises : ConfigError where `what` is not known, the file's ending is none of FORMATS or it cannot be written
    """
    if what not in WHAT:
        raise ConfigError(f"plot {what!r}; there are: {', '.join(sorted(WHAT))}")
    if path.suffix.lower() not in FORMATS:
        raise ConfigError(f"{path}: pictures end in {', '.join(FORMATS)}")
    figure = WHAT[what](fetch, frames, up)
    beside = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        figure.savefig(beside, dpi=150, bbox_inches="tight")
        beside.replace(path)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        beside.unlink(missing_ok=True)


def _figure(width: float, height: float, columns: int = 1, rows: int = 1) -> "tuple[Figure, Any]":
    """A figure that belongs to no window, so that no display is needed."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots(rows, columns)


def _view(bodies: list[Floats], up: int | None) -> Floats:
    """(xyz, 3) axes across, up and towards the eye, all axes of the coordinates: files do not say which way is up.

    The eye looks along the shortest extent. Where nobody says what is up, it is the one of the other two axes along which
    the body's lowest point moves least: feet stand on the ground.
    """
    lowest = np.array([V.min(axis=0) for V in bodies])
    extent = np.mean([np.ptp(V, axis=0) for V in bodies], axis=0)
    eye = min((axis for axis in range(3) if axis != up), key=lambda axis: float(extent[axis]))
    if up is None:
        sways = np.ptp(lowest, axis=0) - 1e-6 * extent  # of two that do not move, the longer
        up = min((axis for axis in range(3) if axis != eye), key=lambda axis: float(sways[axis]))
    across = 3 - eye - up
    view = np.eye(3)[:, [across, up, eye]]
    view[:, 2] *= np.linalg.det(view)
    return np.asarray(view, dtype=np.float64)


def _surface(axes: "Axes", X: Floats, F: Ints, values: Floats) -> None:
    """Faces from the farthest to the nearest, coloured by μ and shaded by how they face the eye; grey where μ is not."""
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection

    corners = X[F]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    towards = normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    order = order[towards[order] > 0] if (towards > 0).any() else order
    level = values[F].mean(axis=1)
    low, high = np.nanmin(values), np.nanmax(values)
    colour = colormaps["viridis"](np.nan_to_num((level - low) / max(high - low, 1e-300)))
    colour[np.isnan(level)] = (0.7, 0.7, 0.7, 1.0)
    colour[:, :3] *= (0.45 + 0.55 * np.clip(towards, 0, 1))[:, None]
    flat = list(corners[order, :, :2])
    axes.add_collection(PolyCollection(flat, facecolors=colour[order], edgecolors="face", linewidths=0.1))
    axes.set(aspect="equal", xlim=_range(X[:, 0]), ylim=_range(X[:, 1]))
    axes.set_axis_off()


def _leaves(axes: "Axes", followed: Artifact, frame: int, view: Floats) -> None:
    told: Any = followed
    at = told.frames.index(frame)
    for leaf, position in enumerate(told.positions[:, at]):
        if not np.isnan(position).any():
            x, y, _ = position @ view
            seen = told.rows[leaf, at] >= 0
            colour = LEAF_COLOURS[leaf % len(LEAF_COLOURS)]
            axes.plot(x, y, "o", ms=7, color=colour if seen else "none", mec=colour if not seen else "white")
            axes.annotate(str(leaf), (x, y), xytext=(5, 5), textcoords="offset points", fontsize=8, color=colour, bbox=BEHIND)


def _range(x: NDArray[np.float64]) -> tuple[float, float]:
    margin = 0.06 * float(np.ptp(x))
    return float(x.min()) - margin, float(x.max()) + margin
