"""A table as a value: printed, written as CSV or as JSON."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kinetree.errors import ConfigError

Cell = str | float | int | None


@dataclass(frozen=True)
class Table:
    """Rows under named columns; None where there is no value."""

    name: str
    """Stem of its file, e.g. table-1."""
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()

    def csv(self) -> str:
        """All values in full, an empty cell where there is none."""
        file = io.StringIO()
        csv.writer(file, lineterminator="\n").writerows([self.columns, *self.rows])
        return file.getvalue()

    def json(self) -> dict[str, Any]:
        """The table as JSON values, one object a row."""
        rows = [dict(zip(self.columns, row, strict=True)) for row in self.rows]
        return {"name": self.name, "title": self.title, "rows": rows, "notes": list(self.notes)}

    def cells(self) -> list[list[str]]:
        """The rows as text, numbers to three digits."""
        return [[_text(cell) for cell in row] for row in self.rows]

    def write(self, folder: Path) -> Path:
        """Writes the CSV into a folder that there is; raises ConfigError where it cannot."""
        path = folder / f"{self.name}.csv"
        try:
            path.write_text(self.csv(), encoding="utf-8")
        except OSError as error:
            raise ConfigError(f"{path}: cannot be written: {error.strerror}") from error
        return path


def _text(cell: Cell) -> str:
    if cell is None:
        return "–"
    if isinstance(cell, float):
        return f"{cell:.3g}" if abs(cell) < 1000 else f"{cell:,.0f}"
    return f"{cell:,}" if isinstance(cell, int) else cell
