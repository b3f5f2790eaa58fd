"""The page as one file of HTML: what was found, drawn and told, every word from outside escaped."""

import base64
import io
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Literal

from kinetree.schemas.results.report import RUN
from kinetree.tasks.results.page.scene import Scene
from kinetree.tasks.results.plots.drawing import verbatim

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Section:
    """One chapter of the page: HTML that is safe already."""

    anchor: str
    heading: str
    body: str


@dataclass(frozen=True)
class Page:
    """All that the page tells."""

    title: str
    facts: Sequence[tuple[str, str]]
    warnings: Sequence[str]
    scene: Scene
    sections: Sequence[Section] = field(default_factory=tuple)


def document(page: Page) -> str:
    """The whole page, with `RUN` where what ran is to stand."""
    ran = '<div id="ran"><p class="soft">Known only to a run that is over.</p></div>'
    sections = [*page.sections, Section("run", "What ran", ran)]
    parts = {
        "title": escape(page.title),
        "style": _file("style.css"),
        "nav": "".join(f'<a href="#{s.anchor}">{escape(s.heading)}</a> ' for s in sections),
        "facts": "".join(f"<li>{escape(name)} <b>{escape(value)}</b></li>" for name, value in page.facts),
        "warnings": warnings(page.warnings),
        "intervals": "".join(
            f'<option value="{i["at"]}">{n}: frames {i["begin"]}–{i["end"]}</option>'
            for n, i in enumerate(page.scene.told["intervals"])
        ),
        "omitted": escape("; ".join(page.scene.omitted)) + ("." if page.scene.omitted else ""),
        "sections": "".join(f'<section id="{s.anchor}"><h2>{escape(s.heading)}</h2>{s.body}</section>' for s in sections),
        "scene": as_script(page.scene.told),
        "payload": page.scene.block,
        "run": RUN,
        "three": _file("vendor/three.min.js"),
        "viewer": _file("viewer.js"),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found.group(1)], _file("page.html"))


def as_script(told: Any) -> str:
    """JSON that can lie in a script element: no end of the element, no comment can hide in a string."""
    text = json.dumps(told, ensure_ascii=True, allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def warnings(told: Sequence[str]) -> str:
    """The box of warnings; nothing where there are none."""
    if not told:
        return ""
    items = "".join(f"<li>{escape(text)}</li>" for text in told)
    return f'<aside class="warnings" aria-labelledby="heed"><h2 id="heed">To heed</h2><ul>{items}</ul></aside>'


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A table that scrolls by itself on a narrow screen; numbers to the right."""
    numeric = [all(isinstance(row[i], int | float) for row in rows) for i in range(len(head))]
    kind = [' class="n"' if n and rows else "" for n in numeric]
    top = "".join(f'<th scope="col"{k}>{escape(h)}</th>' for h, k in zip(head, kind, strict=True))
    body = "".join(
        "<tr>" + "".join(f"<td{k}>{escape(_text(c))}</td>" for c, k in zip(row, kind, strict=True)) + "</tr>" for row in rows
    )
    return f'<div class="scroll" tabindex="0"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def picture(drawn: "Figure", caption: str, *, vector: bool = True) -> str:
    """A figure in the page itself: lines as SVG, surfaces as PNG."""
    return embedded(rendered(drawn, vector=vector), caption, "svg" if vector else "png")


def rendered(drawn: "Figure", *, vector: bool) -> bytes:
    """A figure as the bytes of a file, the same for the same figure."""
    from matplotlib import rc_context

    out = io.BytesIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "kinetree"}):
        if vector:
            verbatim(drawn).savefig(out, format="svg", metadata={"Date": None, "Creator": None})
        else:
            verbatim(drawn).savefig(out, format="png", dpi=110, metadata={"Software": None})
    return out.getvalue()


def embedded(content: bytes, caption: str, kind: Literal["png", "svg"]) -> str:
    """A picture in the page itself; its caption is its text for those who cannot see it."""
    data = base64.b64encode(content).decode()
    media = "svg+xml" if kind == "svg" else kind
    return (
        f'<figure><div class="scroll" tabindex="0"><img alt="{escape(caption)}" src="data:image/{media};base64,{data}"></div>'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def _text(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _file(name: str) -> str:
    return files("kinetree.tasks.results.page").joinpath(name).read_text(encoding="utf-8")
