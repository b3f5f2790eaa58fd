"""The page as one file of HTML; all text from outside is escaped."""

import base64
import hashlib
import io
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from kinetree.schemas.results.report import RUN
from kinetree.schemas.results.verdict import Level
from kinetree.tasks.results.formats.colours import KINDS, NOT_RIGID, SURFACE_LEAF
from kinetree.tasks.results.page.scene import Scene
from kinetree.tasks.results.plots.drawing import verbatim
from kinetree.tasks.results.plots.style import PAGE_DOTS, following_the_page, rendering

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MARKS: dict[Level, str] = {"good": "✓", "except": "!", "unusable": "✗"}
"""Beside the words of a verdict."""
OPEN_FAULTS = 4
"""Most reasons of a verdict that stand above the player without being unfolded, so that its controls stay on the screen."""
ROUNDING = 1e-5
"""Number in a table below which it is what rounding left of 0: a joint that shape alone gives turns by 3e-06°."""
ASSUMED_ENTRY = '<span><span class="key hollow"></span> assumed, not found, on a dashed bone</span>'
LEGEND = {**KINDS, "leaf on the surface": SURFACE_LEAF, "surface that is not rigid": NOT_RIGID}


@dataclass(frozen=True)
class Section:
    """One chapter of the page; its body is HTML in which all text is escaped. Details are folded, all together."""

    anchor: str
    heading: str
    body: str
    is_detail: bool = False


@dataclass(frozen=True)
class Remark:
    """A sentence, with the frame and the joint to which it leads, where it is about one.

    frame : source frame number
    joint : number of the joint
    """

    text: str
    frame: int | None = None
    joint: int | None = None


@dataclass(frozen=True)
class Page:
    """The content of a page: the verdict with its faults, notes that do not change it, and facts as names with values."""

    title: str
    level: Level
    headline: str
    scene: Scene
    facts: Sequence[tuple[str, str]] = ()
    faults: Sequence[Remark] = ()
    notes: Sequence[Remark] = ()
    sections: Sequence[Section] = field(default_factory=tuple)


def document(page: Page) -> str:
    """The whole page, with `RUN` where the record of the run is inserted when the run has ended."""
    run = '<div id="ran"><p class="soft">Known when the run has ended.</p></div>'
    first, details = ([s for s in page.sections if s.is_detail is folded] for folded in (False, True))
    sections = [*first, *details, Section("run", "What ran", run)]
    scripts = {
        "three": page_file("vendor/three.min.js"),
        "viewer": "\n".join(page_file(name) for name in ("player.js", "report_player.js", "viewer.js")),
    }
    parts = {
        "title": escape(page.title),
        "style": page_file("style.css"),
        "nav": "".join(f'<a href="#{s.anchor}">{escape(s.heading)}</a> ' for s in sections),
        "facts": "".join(f"<li>{escape(name)} <b>{escape(value)}</b></li>" for name, value in page.facts),
        "verdict": verdict(page),
        "notes": notes(page.notes),
        "intervals": "".join(
            f'<option value="{i["at"]}">{n}: frames {i["begin"]}–{i["end"]}</option>'
            for n, i in enumerate(page.scene.description["intervals"])
        ),
        **_bounds("bound" in page.scene.description["arrays"]),
        "colours": '<option value="input">the input’s own</option>' if "colours" in page.scene.description["arrays"] else "",
        "omitted": escape("; ".join(page.scene.omitted)) + ("." if page.scene.omitted else ""),
        "sections": _chapters(first) + _folded("Method details", details) + _folded("What ran", sections[-1:]),
        "scene": as_script(page.scene.description),
        "payload": base64.b64encode(page.scene.block).decode(),
        "run": RUN,
        "hashes": script_hashes(scripts.values()),
        **scripts,
        "legend": "".join(legend_entry(name, colour) for name, colour in LEGEND.items())
        + (ASSUMED_ENTRY if page.scene.description.get("assumed") else ""),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match.group(1)], page_file("page.html"))


def _bounds(known: bool) -> dict[str, str]:
    """The switch for error bounds, its key and its legend, where a page has bounds."""
    box = '<label><input id="see-bounds" type="checkbox"> Error bounds (90 %)</label>\n'
    key = " <kbd>B</kbd> shows the error bound of every joint,"
    return {"bounds": box if known else "", "bounds_key": key if known else ""}


def as_script(value: Any) -> str:
    """JSON for a script element: no string in it can end the element or begin a comment."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def script_hashes(scripts: Iterable[str]) -> str:
    """What a page's policy says of its scripts: a browser runs none that is not exactly one of these (CSP 3, Sec. 8.3)."""
    digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts]
    return " ".join(f"'sha256-{digest}'" for digest in digests)


def _chapters(sections: Sequence[Section]) -> str:
    return "".join(f'<section id="{s.anchor}"><h2>{escape(s.heading)}</h2>{s.body}</section>' for s in sections)


def _folded(heading: str, sections: Sequence[Section]) -> str:
    if not sections:
        return ""
    return f'<details class="chapter"><summary>{escape(heading)}</summary>{_chapters(sections)}</details>'


def verdict(page: Page) -> str:
    """The verdict with its reasons as HTML."""
    heading = f'<h2 id="verdict"><span aria-hidden="true">{MARKS[page.level]}</span> {escape(page.headline)}</h2>'
    first, more = page.faults[:OPEN_FAULTS], page.faults[OPEN_FAULTS:]
    folded = f"<details><summary>{len(more)} more</summary>{_remarks(more)}</details>" if more else ""
    return f'<section class="verdict {page.level}" aria-labelledby="verdict">{heading}{_remarks(first)}{folded}</section>'


def notes(remarks: Sequence[Remark]) -> str:
    """Notes, folded, as HTML; empty where there are none."""
    if not remarks:
        return ""
    heading = f"{len(remarks)} note{'s' * (len(remarks) != 1)} that do{'es' * (len(remarks) == 1)} not change this"
    return f'<details class="notes"><summary>{heading}</summary>{_remarks(remarks)}</details>'


def _remarks(remarks: Sequence[Remark]) -> str:
    """A list; what is about a frame or a joint is a button that leads there."""
    return f"<ul>{''.join(f'<li>{_remark(remark)}</li>' for remark in remarks)}</ul>" if remarks else ""


def _remark(remark: Remark) -> str:
    places = {"frame": remark.frame, "joint": remark.joint}
    data = "".join(f' data-{name}="{number}"' for name, number in places.items() if number is not None)
    return f'<button type="button" class="go"{data}>{escape(remark.text)}</button>' if data else escape(remark.text)


def table(head: Sequence[str], rows: Sequence[Sequence[object]], *, joints: bool = False) -> str:
    """A table as HTML that scrolls on a narrow screen; columns of numbers are aligned to the right.

    joints : whether row j is about joint j, so that it is selected by its first cell
    """
    numeric = [all(isinstance(row[i], int | float) for row in rows) for i in range(len(head))]
    kind = [' class="n"' if n and rows else "" for n in numeric]
    top = "".join(f'<th scope="col"{k}>{escape(h)}</th>' for h, k in zip(head, kind, strict=True))
    body = "".join(
        f'<tr data-joint="{j}">{_pick(row[0])}{_cells(row[1:], kind[1:])}</tr>' if joints else f"<tr>{_cells(row, kind)}</tr>"
        for j, row in enumerate(rows)
    )
    return f'<div class="scroll" tabindex="0"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def _cells(row: Sequence[object], kind: Sequence[str]) -> str:
    return "".join(f"<td{k}>{escape(_text(c))}</td>" for c, k in zip(row, kind, strict=True))


def _pick(name: object) -> str:
    return f'<td><button type="button" class="pick" aria-pressed="false">{escape(_text(name))}</button></td>'


def picture(figure: "Figure", caption: str, alternative: str) -> str:
    """A figure as HTML that contains its file."""
    return embedded(rendered(figure), caption, alternative)


def rendered(figure: "Figure") -> bytes:
    """A figure as the bytes of an SVG file, its surfaces as pixels; equal figures give equal bytes."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    file = io.BytesIO()
    with rendering():  # the canvas itself draws once; savefig draws twice where there is a layout
        verbatim(figure).set_dpi(PAGE_DOTS)
        FigureCanvasSVG(figure).print_svg(file, metadata={"Date": None, "Creator": None})
    return following_the_page(file.getvalue())


def embedded(content: bytes, caption: str, alternative: str) -> str:
    """An SVG picture as HTML that contains its file."""
    data = base64.b64encode(content).decode()
    image = f'<img alt="{escape(alternative)}" src="data:image/svg+xml;base64,{data}">'
    return f'<figure><div class="scroll" tabindex="0">{image}</div><figcaption>{escape(caption)}</figcaption></figure>'


def _text(value: object) -> str:
    """A cell of a table as text; what rounding left of 0 is 0."""
    if not isinstance(value, float):
        return str(value)
    return "0" if abs(value) < ROUNDING else f"{value:.4g}"


def legend_entry(name: str, colour: str) -> str:
    """One entry of the legend below the player."""
    return f'<span><span class="key" style="background:{colour}"></span> {escape(name)}</span>'


def page_file(name: str) -> str:
    """The text of a file beside this module."""
    return files("kinetree.tasks.results.page").joinpath(name).read_text(encoding="utf-8")
