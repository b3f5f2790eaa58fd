"""A place that only reads from another one and keeps what is written in memory: for a store that cannot be written.

It is known in this process alone and gone with whoever holds it.
"""

import secrets
import weakref
from collections.abc import Iterable

from kinetree.pipeline.storage.place import Listed, Place

SCHEME = "memory://"
_open: "weakref.WeakValueDictionary[str, Overlay]" = weakref.WeakValueDictionary()


class Overlay:
    """A `Place` whose writes and removals stay in memory, above one that is only read."""

    def __init__(self, below: Place) -> None:
        self.url = f"{SCHEME}{secrets.token_hex(8)}"
        self.is_remote = below.is_remote
        self._below = below
        self._held: dict[str, bytes | None] = {}
        """What was written, by path; None for what was removed."""
        _open[self.url] = self

    def get(self, path: str) -> bytes | None:
        """The bytes at `path`; None where nothing is."""
        return self._held[path] if path in self._held else self._below.get(path)

    def get_all(self, paths: Iterable[str]) -> dict[str, bytes | None]:
        """The bytes at every path, in their order; None where nothing is."""
        wanted = list(paths)
        below = self._below.get_all([path for path in wanted if path not in self._held])
        return {path: self._held[path] if path in self._held else below[path] for path in wanted}

    def tail(self, path: str, count: int) -> tuple[bytes, int] | None:
        """The last bytes of an object, and how many it has in all; None where nothing is."""
        if path not in self._held:
            return self._below.tail(path, count)
        data = self._held[path]
        return None if data is None else (data[max(0, len(data) - count) :], len(data))

    def part(self, path: str, start: int, stop: int) -> bytes | None:
        """The bytes from start to stop; None where nothing is."""
        if path not in self._held:
            return self._below.part(path, start, stop)
        data = self._held[path]
        return None if data is None else data[start:stop]

    def put(self, path: str, data: bytes) -> None:
        """Keeps one object in memory."""
        self._held[path] = data

    def size(self, path: str) -> int | None:
        """Bytes of one object; None where nothing is."""
        if path not in self._held:
            return self._below.size(path)
        data = self._held[path]
        return None if data is None else len(data)

    def names(self, path: str) -> list[str]:
        """Names directly below `path`, sorted; of a folder from which the last object was removed none."""
        within = f"{path}/" if path else ""
        inside = {name[len(within) :]: data for name, data in self._held.items() if name.startswith(within)}
        present = {name.partition("/")[0] for name, data in inside.items() if data is not None}
        less = {name.partition("/")[0] for name, data in inside.items() if data is None} - present
        gone = less - {name.partition("/")[0] for name in self.listed(path)} if less else less
        return sorted(({*self._below.names(path)} - gone) | present)

    def listed(self, path: str) -> dict[str, Listed]:
        """Every object below `path`, by path relative to it, sorted; empty where nothing is."""
        within = f"{path}/" if path else ""
        entries: dict[str, Listed] = dict(self._below.listed(path))
        for name, data in self._held.items():
            if name.startswith(within):
                entries.pop(name[len(within) :], None)
                if data is not None:
                    entries[name[len(within) :]] = Listed(len(data), 0.0)
        return dict(sorted(entries.items()))

    def modified(self, path: str) -> float:
        """Seconds since the epoch of the last change of an object; 0 where nothing is, and for what is in memory."""
        return 0.0 if path in self._held else self._below.modified(path)

    def remove(self, path: str) -> None:
        """Removes an object, or all below a folder; nothing happens where nothing is."""
        within = f"{path}/" if path else ""
        inside = [f"{within}{name}" for name in self.listed(path)]
        self._held |= dict.fromkeys(inside or [path])

    def remove_all(self, paths: Iterable[str]) -> None:
        """Removes objects; nothing happens where nothing is."""
        for path in paths:
            self.remove(path)


def opened(url: str) -> Overlay | None:
    """The overlay of that address that this process has; None where there is none."""
    return _open.get(url)
