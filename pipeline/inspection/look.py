"""How the list of runs and a comparison look in a shell and in a notebook: plain dictionaries and lists otherwise."""

import html
from collections.abc import Sequence
from typing import Any

RUN_COLUMNS = ("name", "status", "ran", "fresh", "failed", "seconds", "output")


class RunList(list[dict[str, Any]]):
    """The runs on record; shown as a table, one line a run."""

    def rows(self) -> list[tuple[str, ...]]:
        """The cells of the table."""
        runs = [{**run, **run.get("counts", {})} for run in self]
        return [tuple(str(run.get(column, "")) for column in RUN_COLUMNS) for run in runs]

    def __repr__(self) -> str:
        return "\n".join("  ".join(row) for row in [RUN_COLUMNS, *self.rows()])

    def _repr_html_(self) -> str:
        return html_table(RUN_COLUMNS, self.rows())


class Difference(dict[str, Any]):
    """What differs between two runs; shown as where it starts and how many nodes it reached."""

    def __repr__(self) -> str:
        lines = [f"{self['a']} → {self['b']}: {len(self['changed'])} nodes have other results"]
        lines += [f"  starts at {node}: {'; '.join(reasons)}" for node, reasons in self["begins"].items()]
        for word, names in (("only in the first", self["only_a"]), ("only in the second", self["only_b"])):
            lines += [f"  {word}: {len(names)} nodes"] if names else []
        return "\n".join(lines)


class Table(list[dict[str, Any]]):
    """Rows with the same columns; shown as a table."""

    def _cells(self) -> list[tuple[str, ...]]:
        return [tuple("" if value is None else str(value) for value in row.values()) for row in self]

    def __repr__(self) -> str:
        head = tuple(self[0]) if self else ()
        return "\n".join("  ".join(row) for row in [head, *self._cells()])

    def _repr_html_(self) -> str:
        return html_table(tuple(self[0]) if self else (), self._cells())


def html_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table for a notebook, every cell escaped."""
    top = "".join(f"<th>{html.escape(cell)}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
