"""The means of all pictures: figures without a window, views of a body, surfaces as shaded faces, colours of values."""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import ConfigError
from kinetree.schemas.array import Floats, Ints
from kinetree.tasks.results.formats.colours import LINES
from kinetree.tasks.results.plots.style import Style, following_the_page, for_paper, rendering

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Fetch = Callable[..., Any]
"""Gives the artifact of a task at an index, as `Pipeline.artifact` does."""
FORMATS = (".png", ".svg", ".pdf")
"""How a picture's name may end."""
LABEL_BOX = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.8}
COLOURS = LINES
RESOLUTION: dict[Style, int] = {"screen": 150, "paper": 300}
"""Dots per inch of files; in SVG and PDF only surfaces are dots."""


def blank(width: float, height: float, columns: int = 1, rows: int = 1) -> "tuple[Figure, Any]":
    """A figure without a window, which needs no display, and its axes.

    width, height : of the figure, inches
    columns, rows : of the grid of axes
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots(rows, columns)


def words(text: str) -> "Figure":
    """A figure that says why there is nothing to see."""
    figure, axes = blank(5.0, 1.0)
    axes.set_axis_off()
    axes.text(0.5, 0.5, text, ha="center", va="center", fontsize=10)
    return figure


def verbatim(figure: "Figure") -> "Figure":
    """The figure with all text printed as it is: a $ in a name does not begin a formula."""
    for text in _texts(figure):
        text.set_parse_math(False)
    return figure


def _texts(artist: Any) -> Iterator[Any]:
    """All texts below an artist. Whoever looks into an axis makes its ticks, which axes that are off never show."""
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.text import Text

    if isinstance(artist, Text):
        yield artist
    is_off = isinstance(artist, Axes) and not artist.axison
    for child in artist.get_children():
        if not (is_off and isinstance(child, Axis)):
            yield from _texts(child)


def write_figure(figure: "Figure", path: Path, style: Style = "screen") -> None:
    """Writes a picture, complete or not at all; raises ConfigError where it cannot be written, or would replace a device."""
    if path.exists() and not path.is_file():
        raise ConfigError(f"{path}: no file, and would be replaced by one; name another path")
    beside = path.with_name(f".{path.stem}.part{path.suffix}")
    is_svg = path.suffix.lower() == ".svg"
    fitted = for_paper(figure) if style == "paper" else figure
    try:
        with rendering():
            verbatim(fitted).savefig(beside, dpi=RESOLUTION[style], bbox_inches=None if style == "paper" else "tight")
        if is_svg and style == "screen":
            beside.write_bytes(following_the_page(beside.read_bytes()))
        beside.replace(path)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            beside.unlink()


def view(bodies: list[Floats], up: int = 1) -> Floats:
    """The directions of a view: to the right, up and towards the viewer, each along an axis of the coordinates.

    The viewer looks along the shorter of the two extents across the up axis.

    bodies  : (vertex, xyz) of every frame that is shown
    up      : axis that points up: 0, 1, 2 for x, y, z, and ~0, ~1, ~2 for the opposite directions
    returns : (xyz, 3) columns are the directions
    """
    return directions(np.mean([np.ptp(V, axis=0) for V in bodies], axis=0), up)


def directions(extent: Floats, up: int = 1) -> Floats:
    """The directions of a view of bodies of an extent, as `view` gives them.

    extent : (xyz,) mean over the bodies
    """
    axis = up if up >= 0 else ~up
    eye = min((a for a in range(3) if a != axis), key=lambda a: float(extent[a]))
    view = np.eye(3)[:, [3 - eye - axis, axis, eye]]
    view[:, 1] *= 1.0 if up >= 0 else -1.0
    view[:, 2] *= np.linalg.det(view)
    return np.asarray(view, dtype=np.float64)


def surface(axes: "Axes", X: Floats, F: Ints, colour: Floats) -> None:
    """Draws faces from the farthest to the nearest, brighter the more they face the viewer.

    X      : (vertex, xyz) to the right, up and towards the viewer, as `view` gives them
    F      : (face, corner)
    colour : (face, 4) red, green, blue and opacity from 0 to 1
    """
    from matplotlib.collections import PolyCollection

    corners = X[F]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    towards = normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    order = order[towards[order] > 0] if (towards > 0).any() else order
    shaded = colour.copy()
    shaded[:, :3] *= (0.45 + 0.55 * np.clip(towards, 0, 1))[:, None]
    flat: Any = corners[order, :, :2]
    faces = PolyCollection(flat, facecolors=shaded[order], edgecolors="face", linewidths=0.1, rasterized=True)
    axes.add_collection(faces, autolim=False)
    axes.set(aspect="equal", xlim=limits(X[:, 0]), ylim=limits(X[:, 1]))
    axes.set_axis_off()


def tall(bodies: "Sequence[Floats]", width: float) -> float:
    """Height of pictures beside one another in which bodies of this extent fill the width, inches.

    bodies : (vertex, xyz) of every picture, in the directions of its view
    width  : of one picture, inches
    """
    ratio = float(np.max([np.ptp(X[:, 1]) for X in bodies])) / max(float(np.max([np.ptp(X[:, 0]) for X in bodies])), 1e-300)
    return float(np.clip(width * ratio, 0.5 * width, 1.4 * width)) + 0.4


def same_scale(panels: "Sequence[Axes]") -> None:
    """Makes surfaces beside one another equally large, each about its own centre."""
    for name in ("x", "y"):
        spans = [getattr(axes, f"get_{name}lim")() for axes in panels]
        half = max(high - low for low, high in spans) / 2
        for axes, (low, high) in zip(panels, spans, strict=True):
            getattr(axes, f"set_{name}lim")((low + high) / 2 - half, (low + high) / 2 + half)


def levels(F: Ints, values: Floats, low: float | None = None, high: float | None = None) -> Floats:
    """Colours of a quantity given at vertices; grey where it is not known.

    F         : (face, corner)
    values    : (vertex,) NaN where not known
    low, high : ends of the scale; None for the smallest and the largest value
    returns   : (face, 4) red, green, blue and opacity from 0 to 1
    """
    from matplotlib import colormaps

    level = values[F].mean(axis=1)
    low = float(np.nanmin(values)) if low is None else low
    high = float(np.nanmax(values)) if high is None else high
    colour: Floats = colormaps["viridis"](np.nan_to_num((level - low) / max(high - low, 1e-300)))
    colour[np.isnan(level)] = (0.7, 0.7, 0.7, 1.0)
    return colour


def graded(highest: float) -> Any:
    """The scale of colours from 0 to the highest value, for lines and a colour bar."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    return ScalarMappable(Normalize(0.0, highest), "viridis")


def limits(x: NDArray[np.float64]) -> tuple[float, float]:
    """The range of x with a margin of 6 % on both sides."""
    margin = 0.06 * float(np.ptp(x))
    return float(x.min()) - margin, float(x.max()) + margin
