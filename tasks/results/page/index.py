"""The page over all sequences of a data set: a small picture and the figures of each, with a link to its report."""

import base64
import io
import re
from collections.abc import Sequence
from html import escape
from statistics import fmean
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from kinetree.schemas.results.sequence_table import SequenceRow, SequenceTable
from kinetree.tasks.results.page.document import MARKS, page_file
from kinetree.tasks.views.verdict import WORDS

REPORT = "report.html"
HEAD = ("", "sequence", "status", "verdict", "frames", "joints", "confidence", "true joints found", "error, % of height",
        "spurious", "seconds of computing", "remarks")  # fmt: skip
NUMBERS = range(4, 11)
"""Columns that hold numbers."""


def index_page(table: SequenceTable) -> str:
    """The whole page; it needs no network, and all text from outside is escaped."""
    rows = table.rows
    failed = [row for row in rows if row.outcome.failures]
    parts = {
        "title": f"{len(rows)} sequences",
        "style": page_file("style.css"),
        "facts": "".join(f"<li>{escape(name)} <b>{escape(value)}</b></li>" for name, value in _facts(rows)),
        "failures": _failures(failed),
        "head": "".join(f"<th{' class=n' if n in NUMBERS else ''}>{name}</th>" for n, name in enumerate(HEAD)),
        "rows": "\n".join(_row(row, table) for row in rows),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match.group(1)], page_file("index.html"))


def _facts(rows: Sequence[SequenceRow]) -> list[tuple[str, str]]:
    states = [row.outcome.status for row in rows]
    facts = [(state, str(states.count(state))) for state in dict.fromkeys(sorted(states))]
    levels = [row.verdict for row in rows]
    facts += [(words.removesuffix(" for"), str(levels.count(level))) for level, words in WORDS.items() if level in levels]
    scored = [row for row in rows if row.scored is not None]
    if scored:
        matched, total = sum(row.found or 0 for row in scored), sum(row.scored or 0 for row in scored)
        facts.append(("true joints found", f"{matched} of {total}"))
    errors = [row.percent for row in rows if row.percent is not None]
    if errors:
        facts.append(("mean error", f"{fmean(errors):.2f} % of the height"))
    facts.append(("computing", f"{sum(row.outcome.seconds for row in rows):.0f} s"))
    return facts


def _failures(failed: Sequence[SequenceRow]) -> str:
    if not failed:
        return ""
    lines = "".join(
        f"<li><b>{escape(row.outcome.name)}</b>: {escape(row.outcome.failures[0])}{_more(len(row.outcome.failures) - 1)}</li>"
        for row in failed
    )
    return f'<div class="warnings"><h2>Failed</h2><ul>{lines}</ul></div>'


def _more(count: int) -> str:
    return f" and {count} more" if count > 0 else ""


def _row(row: SequenceRow, table: SequenceTable) -> str:
    outcome = row.outcome
    name = escape(outcome.name)
    if REPORT in outcome.files:
        name = f'<a href="{escape(quote(f"{outcome.output}/{REPORT}"))}">{name}</a>'
    picture = "" if row.picture is None else f'<img alt="" src="{_address(table.pictures[row.picture])}">'
    status = escape(outcome.status)
    matched = "" if row.scored is None else f"{row.found} of {row.scored}"
    cells = [
        picture,
        name,
        f'<span class="failed">{status}</span>' if outcome.failures else status,
        _verdict(row),
        _text(row.frames),
        _text(row.joints),
        "" if row.confidence is None else f"{row.confidence:.2f}",
        matched,
        "" if row.percent is None else f"{row.percent:.2f}",
        _text(row.spurious),
        f"{outcome.seconds:.1f}" if row.picture is not None else "",
        _remarks(outcome.remarks),
    ]
    return "<tr>" + "".join(f"<td{' class=n' if n in NUMBERS else ''}>{cell}</td>" for n, cell in enumerate(cells)) + "</tr>"


def _verdict(row: SequenceRow) -> str:
    """The verdict's mark and its sentence."""
    if row.verdict is None:
        return ""
    mark = f'<b aria-hidden="true">{MARKS[row.verdict]}</b>'
    return f'<span class="judged {row.verdict}">{mark} {escape(row.verdict_words or "")}</span>'


def _remarks(remarks: Sequence[str]) -> str:
    if not remarks:
        return ""
    lines = "".join(f"<li>{escape(remark)}</li>" for remark in remarks)
    return f"<details><summary>{len(remarks)}</summary><ul>{lines}</ul></details>"


def _text(value: object) -> str:
    return "" if value is None else str(value)


def _address(pixels: NDArray[np.uint8]) -> str:
    """The picture as the address of an image that holds its data."""
    out = io.BytesIO()
    Image.fromarray(np.asarray(pixels)).quantize(64).save(out, "PNG", optimize=True)
    return f"data:image/png;base64,{base64.b64encode(out.getvalue()).decode('ascii')}"
