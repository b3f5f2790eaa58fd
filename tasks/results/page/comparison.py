"""The page of a comparison as one file of HTML: two players, a curve, and tables whose joints can be selected."""

import base64
import re
from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.results.comparison import ComparedRun, Comparison, UnpairedJoint
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.colours import KINDS, NOT_RIGID, YELLOW
from kinetree.tasks.results.page.document import Section, as_script, legend_entry, page_file, script_hashes, table
from kinetree.tasks.results.page.scene import Scene
from kinetree.tasks.views.results import comparison_remarks, comparison_rows

ONLY_HERE = YELLOW
"""Colour of the joints that only one of the runs has."""
LEGEND = {**KINDS, "only in this run": ONLY_HERE, "surface that is not rigid": NOT_RIGID}
SHARED = ("size", "centre", "reach")
"""What both scenes must have in common for one camera to show them alike."""


def comparison_document(comparison: Comparison, skeletons: tuple[Skeleton, Skeleton], scenes: tuple[Scene, Scene]) -> str:
    """The whole page.

    scenes : of both runs, of the same frames and along the same axes
    """
    rows = _Rows(comparison, skeletons)
    sections = _sections(comparison, rows)
    first, second = (scene.description for scene in scenes)
    omitted = [f"{letter}: {text}" for letter, s in zip("AB", scenes, strict=True) for text in s.omitted]
    scripts = {
        "three": page_file("vendor/three.min.js"),
        "script": "\n".join(page_file(name) for name in ("player.js", "comparison.js")),
    }
    parts = {
        "title": escape(f"{comparison.a.name} and {comparison.b.name} compared"),
        "style": page_file("style.css") + page_file("comparison.css"),
        "nav": "".join(f'<a href="#{s.anchor}">{escape(s.heading)}</a> ' for s in sections),
        "name_a": escape(_caption("A", comparison.a)),
        "name_b": escape(_caption("B", comparison.b)),
        "legend": "".join(legend_entry(name, colour) for name, colour in LEGEND.items()),
        "omitted": escape("; ".join(omitted) + ("." if omitted else "")),
        "sections": "".join(f'<section id="{s.anchor}"><h2>{escape(s.heading)}</h2>{s.body}</section>' for s in sections),
        "comparison": as_script(_content(comparison, rows)),
        "scene_a": as_script(first),
        "scene_b": as_script({**second, **{name: first[name] for name in SHARED}}),
        "payload_a": base64.b64encode(scenes[0].block).decode(),
        "payload_b": base64.b64encode(scenes[1].block).decode(),
        "hashes": script_hashes(scripts.values()),
        **scripts,
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match.group(1)], page_file("comparison.html"))


class _Rows:
    """The rows of all tables in one order, so that the script finds each by its number."""

    def __init__(self, c: Comparison, skeletons: tuple[Skeleton, Skeleton]) -> None:
        self.index = tuple({name: j for j, name in enumerate(s.names)} for s in skeletons)
        share = 100.0 / c.height
        self.all: list[dict[str, Any]] = []
        for k, joint in enumerate(c.true_joints):
            one, two = (_curve(run, run.upper(), e[:, k] * share) for run, e in (("a", c.error_a), ("b", c.error_b)))
            curves = [*([one] if joint.a else []), *([two] if joint.b else [])]
            what = "error, % of the height" if curves else "missing in both runs"
            self._add(f"{joint.name}: {what}", joint.a, joint.b, curves)
        for k, pair in enumerate(c.pairs):
            curve = _curve("both", "distance between A and B", c.distance[:, k] * share)
            self._add(f"{pair.a} in A, {pair.b} in B: distance, % of the height", pair.a, pair.b, [curve])
        for only in c.only_a:
            self._add(f"{only.name}: only in A", only.name, None, [])
        for only in c.only_b:
            self._add(f"{only.name}: only in B", None, only.name, [])

    def _add(self, name: str, a: str | None, b: str | None, curves: list[dict[str, Any]]) -> None:
        joints = {"a": None if a is None else self.index[0][a], "b": None if b is None else self.index[1][b]}
        self.all.append({"name": name, "curves": curves, **joints})


def _content(c: Comparison, rows: _Rows) -> dict[str, Any]:
    """What the script needs beside the scenes."""
    return {
        "frames": c.frames,
        "rows": rows.all,
        "mean": {**_mean(c), "a": None, "b": None},
        "only_a": [rows.index[0][joint.name] for joint in c.only_a],
        "only_b": [rows.index[1][joint.name] for joint in c.only_b],
        "only_colour": ONLY_HERE,
    }


def _mean(c: Comparison) -> dict[str, Any]:
    """The curve of all joints together: errors of the true joints that both found, or distances of the pairs."""
    share = 100.0 / c.height
    scored = np.array([joint.scored for joint in c.true_joints], dtype=bool)
    common = scored & np.isfinite(c.error_a).all(axis=0) & np.isfinite(c.error_b).all(axis=0)
    if common.any():
        one, two = (e[:, common].mean(axis=1) * share for e in (c.error_a, c.error_b))
        name = f"mean error of the {int(common.sum())} joints that both found, % of the height"
        return {"name": name, "curves": [_curve("a", "A", one), _curve("b", "B", two)]}
    joints = [pair.kind == "joint" for pair in c.pairs]
    if not any(joints):
        return {"name": "no joint is in both runs", "curves": []}
    name = f"mean distance of the {sum(joints)} joints that are in both, % of the height"
    return {"name": name, "curves": [_curve("both", "distance between A and B", c.distance[:, joints].mean(axis=1) * share)]}


def _curve(run: str, name: str, values: Floats) -> dict[str, Any]:
    return {"run": run, "name": name, "values": [float(f"{v:.4g}") if np.isfinite(v) else None for v in values]}


def _caption(letter: str, run: ComparedRun) -> str:
    return f"{letter}: {run.name} ({run.method}, {run.joints} joints)"


def _sections(c: Comparison, rows: _Rows) -> list[Section]:
    """The chapters below the players."""
    remarks = "".join(f"<p>{escape(text)}</p>" for text in comparison_remarks(c))
    start = len(c.true_joints)
    only = start + len(c.pairs)
    unpaired = _unpaired("A", c.only_a, only) + _unpaired("B", c.only_b, only + len(c.only_a))
    sections = [Section("figures", "Figures", table(("", "A", "B"), comparison_rows(c)) + remarks)]
    if c.truth:
        sections.append(Section("truth", f"Against the truth ({c.truth})", _true_table(c)))
    sections += [
        Section("pairs", "Joints in both runs", _pair_table(c, start)),
        Section("only", "Joints in one run alone", f'<div class="tables">{unpaired}</div>'),
        Section("parameters", "Parameters that differ", _parameters(c)),
    ]
    return sections


def _true_table(c: Comparison) -> str:
    head = ("true joint", "range, °", "A", "error, %", "B", "error, %")
    rows = [
        (
            joint.name if joint.scored or joint.kind == "tip" else f"{joint.name} (not scored)",
            "–" if joint.turns is None or joint.kind == "tip" else f"{joint.turns:.0f}",
            joint.a or "missing", _percent(joint.percent_a), joint.b or "missing", _percent(joint.percent_b),
        )
        for joint in c.true_joints
    ]  # fmt: skip
    return _picking(head, rows, 0)


def _pair_table(c: Comparison, start: int) -> str:
    unit = c.unit or "length"
    head = ("in A", "in B", "kind", "mean distance, %", f"mean, {unit}", f"largest, {unit}")
    rows = [(p.a, p.b, p.kind, f"{p.percent:.2f}", f"{p.mean:.4g}", f"{p.worst:.4g}") for p in c.pairs]
    return _picking(head, rows, start)


def _unpaired(letter: str, joints: Sequence[UnpairedJoint], start: int) -> str:
    other = "B" if letter == "A" else "A"
    head = ("joint", "kind", f"nearest in {other}", "distance, %")
    rows = [(joint.name, joint.kind, joint.nearest or "–", _percent(joint.percent)) for joint in joints]
    return f"<div><h3>Only in {letter}</h3>{_picking(head, rows, start) if rows else '<p>None.</p>'}</div>"


def _parameters(c: Comparison) -> str:
    if not c.parameters:
        return "<p>None.</p>"
    rows = [(p.key, "–" if p.a is None else p.a, "–" if p.b is None else p.b) for p in c.parameters]
    return table(("parameter", "A", "B"), rows)


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"


def _picking(head: Sequence[str], rows: Sequence[Sequence[str]], start: int) -> str:
    """A table whose first column is buttons that select a joint; `start` is the number of its first row."""
    if not rows:
        return "<p>None.</p>"
    top = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    body = ""
    for number, (name, *cells) in enumerate(rows, start):
        button = f'<button type="button" class="pick" data-row="{number}" aria-pressed="false">{escape(name)}</button>'
        body += f"<tr><td>{button}</td>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"
    return f'<div class="scroll" tabindex="0"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'
