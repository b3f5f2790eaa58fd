"""A log of JSON lines that begins another file when one is full, and keeps a few."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from kinetree.errors import StoreError


@dataclass
class RotatingLog:
    """A listener; nothing is written before the first event. `log`, `log.1`, `log.2` …, the newest first."""

    path: Path
    size: int
    """Bytes from which another file is begun."""
    keep: int
    """Full files that are kept beside the one that is written."""
    _out: TextIO | None = None

    def hear(self, event: dict[str, Any]) -> None:
        """Writes and flushes one event; raises StoreError where that is refused."""
        try:
            if self._out is None or self._out.tell() > self.size:
                self.close()
                self._out = self._opened()
            self._out.write(json.dumps(event, ensure_ascii=False) + "\n")
            self._out.flush()
        except OSError as error:
            raise StoreError(f"log {self.path}: cannot be written: {error.strerror}; check its permissions") from error

    def close(self) -> None:
        """Ends writing."""
        if self._out is not None:
            self._out.close()
            self._out = None

    def _opened(self) -> TextIO:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        if self.path.exists() and self.path.stat().st_size > self.size:
            for number in range(self.keep, 0, -1):
                older = self._numbered(number - 1)
                if older.exists():
                    older.replace(self._numbered(number))
        return self.path.open("a", encoding="utf-8", errors="backslashreplace")

    def _numbered(self, number: int) -> Path:
        return self.path.with_name(f"{self.path.name}.{number}") if number else self.path
