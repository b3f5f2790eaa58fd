"""Two styles of pictures: for screens, where dark pages turn them dark, and for papers, in columns and in grey."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from kinetree.tasks.results.formats.colours import LINES, linear

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Style = Literal["screen", "paper"]

HEADING = "heading"
"""What marks a title that says what the whole picture is; in a paper the caption does."""
COLUMN, PAGE = 3.5, 7.2
"""Widths of a column and of a page of two columns, inches (89 and 183 mm)."""
SLIM = 5.5
"""Width of a picture for screens, inches, up to which it fits into a column."""
LEAST_SHRINKING = 0.75
"""Share of the height that curves keep at least, since their text does not shrink with them."""
POINTS = 8.0
"""Size of all text in a paper."""
FONTS = ("Arial", "Helvetica", "Liberation Sans", "DejaVu Sans")
"""Fonts without serifs, of which the first one that is installed is taken; matplotlib brings the last."""
LIGHTNESS = dict(zip(LINES, (28.0, 46.0, 58.0, 38.0, 70.0, 82.0, 0.0, 94.0), strict=True))
"""CIE L* of the colours of curves in a paper: at least 8 apart, so that a grey print tells them from one another."""
PAGE_DOTS = 110
"""Dots per inch of surfaces on a page, which are pixels in every file."""
_RENDERING = threading.Lock()
"""matplotlib's settings are those of the process: one figure at a time is written with settings of its own."""
_SETTINGS: dict[str, Any] = {"svg.fonttype": "none", "svg.hashsalt": "kinetree", "pdf.fonttype": 42}
INK, GROUND = "#e8ebee", "#14181c"
"""What black and white are on a dark page."""
_DARK = (
    "<style>@media (prefers-color-scheme: dark) {"
    f' [style*="stroke: #000000"] {{ stroke: {INK} !important }} [style*="fill: #000000"] {{ fill: {INK} !important }}'
    f' [style*="fill: #ffffff"] {{ fill: {GROUND} !important }} text {{ fill: {INK} }} }}</style>'
)


def heading(axes: "Axes", text: str) -> None:
    """A title that says what the whole picture is."""
    axes.set_title(text, fontsize=9).set_gid(HEADING)


def for_paper(figure: "Figure") -> "Figure":
    """The figure as wide as a column or a page, its text in one size without serifs, without headings, grey-safe."""
    from matplotlib.font_manager import fontManager
    from matplotlib.text import Text

    there = {font.name for font in fontManager.ttflist}
    family = next(name for name in FONTS if name in there or name == FONTS[-1])
    width, height = figure.get_size_inches()
    wide = COLUMN if width <= SLIM else PAGE
    least = 0.0 if all(axes.get_aspect() == 1.0 for axes in figure.axes) else LEAST_SHRINKING
    figure.set_size_inches(wide, height * min(1.0, max(wide / width, least)))
    for text in figure.findobj(Text):
        if text.get_gid() == HEADING:
            text.set_text("")
        text.set(fontsize=POINTS, fontfamily=family)
    darker = {colour: _of_lightness(colour, level) for colour, level in LIGHTNESS.items()}
    for artist in figure.findobj():
        _recolour(artist, darker)
    return figure


@contextmanager
def rendering() -> Iterator[None]:
    """The settings with which files are written: text stays text, equal pictures are equal bytes."""
    from matplotlib import rc_context

    with _RENDERING, rc_context(_SETTINGS):
        yield


def following_the_page(svg: bytes) -> bytes:
    """An SVG file that is drawn light on dark where its viewer prefers that; the colours of lines and parts stay."""
    text = svg.decode()
    end = text.index(">", text.index("<svg")) + 1
    return (text[:end] + _DARK + text[end:]).encode()


def _recolour(artist: Any, darker: dict[str, str]) -> None:
    """Replaces the colours of lines, markers, faces, edges and text that a table names."""
    from matplotlib.collections import Collection
    from matplotlib.colors import to_hex, to_rgba
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch
    from matplotlib.text import Text

    names = {
        Line2D: ("color", "markerfacecolor", "markeredgecolor"), Text: ("color",), Patch: ("facecolor", "edgecolor"),
        Collection: ("facecolor", "edgecolor"),
    }  # fmt: skip
    for name in next((names[kind] for kind in names if isinstance(artist, kind)), ()):
        value = getattr(artist, f"get_{name}")()
        if isinstance(artist, Collection):
            rows = [to_rgba(darker.get(to_hex(row).upper(), tuple(row[:3])), row[3]) for row in value]
            if any(to_hex(row).upper() in darker for row in value):
                getattr(artist, f"set_{name}")(rows)
        elif not isinstance(value, str) or value not in ("none", "None"):
            r, g, b, alpha = to_rgba(value)
            if (replaced := darker.get(to_hex((r, g, b)).upper())) is not None:
                getattr(artist, f"set_{name}")(to_rgba(replaced, alpha))


def lightness(colour: str) -> float:
    """CIE L* of a colour such as #0072B2: 0 black, 100 white."""
    rgb = np.frombuffer(bytes.fromhex(colour[1:]), np.uint8)
    y = float(linear(rgb) @ [0.2126, 0.7152, 0.0722])
    return 116.0 * y ** (1 / 3) - 16.0 if y > 0.008856 else 903.3 * y


def _of_lightness(colour: str, level: float) -> str:
    """A colour mixed with black or with white so that it has a lightness."""
    own = np.frombuffer(bytes.fromhex(colour[1:]), np.uint8).astype(np.float64)
    other = np.zeros(3) if lightness(colour) > level else np.full(3, 255.0)
    mixtures = [own + share * (other - own) for share in np.linspace(0.0, 1.0, 256)]
    hexes = ["#" + bytes(np.rint(rgb).astype(np.uint8)).hex() for rgb in mixtures]
    return min(hexes, key=lambda c: abs(lightness(c) - level)).upper()
