"""A small store damaged byte by byte and file by file, and a file system that fails at every write: what became of the result.

    python benchmarks/damage.py [--faults bytes files writes] [--bytes 400] [--stride 1] [--seed 0] [--work FOLDER]

The store is that of three small frames up to `connectivity`. Each fault is put into a copy of it; then the same run is done
again and every artifact is read:

    harmless  nothing was computed, and every artifact reads as before
    mended    something was computed again, and every artifact reads as before
    told      a damaged artifact was named; `verify --repair` and a run made everything as before
    refused   the run ended with exit code 2 and said why
    silent    an artifact reads otherwise and nobody said so          (a fault of kinetree)
    crash     anything else was raised, or repair did not mend it      (a fault of kinetree)

Faults are: one bit of a byte flipped, at so many places drawn at random; each file removed, emptied, cut in half, or
exchanged with another one of its kind; and the n-th write below the output folder failing with EIO, or all from the n-th on
with ENOSPC, for every --stride'th n until a run gets through. After that the run must go on without the fault. Writes are
noticed by the interpreter's audit events (open for writing, rename, mkdir, remove), whoever makes them.
"""

import argparse
import contextlib
import errno
import os
import random
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from kinetree.errors import InputError, KinetreeError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.planning.verify import discard_damage, verify

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
FACES = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
FRAMES = 3
UNTIL = "connectivity"
FAULTS = ("silent", "crash")


def scans(folder: Path) -> None:
    """Three frames of a tetrahedron that grows."""
    folder.mkdir(parents=True)
    for t in range(FRAMES):
        rows = "".join(f"{x} {y} {z}\n" for x, y, z in V * (1 + t / 10))
        (folder / f"{t}.off").write_text(f"OFF\n4 4 0\n{rows}{FACES}")


def pipeline(home: Path) -> Pipeline:
    """The pipeline that reads the scans and keeps everything in `out`."""
    blocks = {"source": {"input": str(home / "scans")}, "output": str(home / "out"), "compute": {"executor": "sync"}}
    return Pipeline.of(blocks)


def ran(home: Path) -> tuple[int, bytes]:
    """How many nodes a run computed, and everything that its artifacts hold; raises what the run raises."""
    line = pipeline(home)
    summary = line.run(until=[UNTIL])
    if summary["failures"]:
        raise RuntimeError(f"failed: {summary['failures'][0]['message']}")
    return int(summary["nodes"]["ran"]), everything(line)


def everything(line: Pipeline) -> bytes:
    """What all artifacts hold, one after the other."""
    there = line.inspect(until=[UNTIL])
    parts = []
    for task, frames in (("source", range(FRAMES)), ("mesh", range(FRAMES)), ("sequence", [None]), ("connectivity", [None])):
        for frame in frames:
            artifact: Any = there.artifact(task, **({} if frame is None else {"frame": frame}))
            for name in sorted(type(artifact).model_fields):
                value = getattr(artifact, name)
                parts.append(name.encode() + (value.tobytes() if isinstance(value, np.ndarray) else repr(value).encode()))
    return b"\0".join(parts)


def outcome(home: Path, expected: bytes) -> tuple[str, str]:
    """What became of a store with a fault in it, and the words of it."""
    try:
        count, result = ran(home)
    except InputError as error:
        return "refused", str(error)
    except KinetreeError as error:
        return _repaired(home, expected, str(error))
    except Exception as error:
        return "crash", f"{type(error).__name__}: {error}"
    if result != expected:
        return "silent", ""
    return ("mended" if count else "harmless"), ""


def _repaired(home: Path, expected: bytes, words: str) -> tuple[str, str]:
    """Whether what was told to be damaged is as before after a repair."""
    try:
        line = pipeline(home)
        discard_damage(line.store, verify(line.store, [line.tasks]))
        return ("told" if ran(home)[1] == expected else "silent"), words
    except Exception as error:
        return "crash", f"after a repair {type(error).__name__}: {error}"


# ── faults ──────────────────────────────────────────────────────────────────────────────────────────────────────────


def flips(store: Path, count: int, rng: random.Random) -> Iterator[tuple[str, Callable[[Path], None]]]:
    """One bit of one byte."""
    places = [(path, n) for path in files(store) for n in range(path.stat().st_size)]
    for path, n in rng.sample(places, min(count, len(places))):
        yield f"bit of {kind(path, store)}", partial(flip, name=path.relative_to(store), at=n, bit=1 << rng.randrange(8))


def flip(root: Path, name: Path, at: int, bit: int) -> None:
    """Turns one bit of a file."""
    data = bytearray((root / name).read_bytes())
    data[at] ^= bit
    (root / name).write_bytes(data)


def changes(store: Path) -> Iterator[tuple[str, Callable[[Path], None]]]:
    """Each file removed, emptied, cut in half, or put in place of the next one of its folder."""
    there = files(store)
    for path in there:
        name = path.relative_to(store)
        others = [p for p in there if p.parent.parent == path.parent.parent and p != path]
        yield f"{kind(path, store)} removed", lambda root, name=name: (root / name).unlink()
        yield f"{kind(path, store)} emptied", lambda root, name=name: (root / name).write_bytes(b"")
        yield (
            f"{kind(path, store)} cut",
            lambda root, name=name: (root / name).write_bytes((root / name).read_bytes()[: (root / name).stat().st_size // 2]),
        )
        if others:
            other = others[0].relative_to(store)
            yield f"{kind(path, store)} swapped", lambda root, name=name, other=other: swap(root / name, root / other)


def swap(a: Path, b: Path) -> None:
    """Each in place of the other."""
    first, second = a.read_bytes(), b.read_bytes()
    a.write_bytes(second)
    b.write_bytes(first)


def files(store: Path) -> list[Path]:
    """All files of a store."""
    return sorted(path for path in store.rglob("*") if path.is_file())


def kind(path: Path, store: Path) -> str:
    """The part of the store that a file belongs to."""
    parts = path.relative_to(store).parts
    return parts[0] if len(parts) > 1 else path.name


class Failing:
    """Lets the n-th write below a folder fail, by the interpreter's audit events; there is one for the whole process."""

    def __init__(self) -> None:
        self.root, self.left, self.code, self.count = "", -1, 0, 0
        sys.addaudithook(self._hear)

    @contextlib.contextmanager
    def at(self, root: Path, number: int, code: int, *, forever: bool) -> Iterator[None]:
        """The write of that number below the root fails, from 0; `forever`: and all after it."""
        self.root, self.left, self.code, self.count, self.forever = str(root), number, code, 0, forever
        try:
            yield
        finally:
            self.root = ""

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.root or event not in ("open", "os.rename", "os.mkdir", "os.remove", "os.rmdir", "os.link", "os.truncate"):
            return
        if event == "open" and not (isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)):
            return
        path = arguments[0]
        if not isinstance(path, str | bytes | os.PathLike) or not os.fsdecode(path).startswith(self.root):
            return
        number, self.count = self.count, self.count + 1
        if number == self.left or (self.forever and number > self.left):
            raise OSError(self.code, os.strerror(self.code), os.fsdecode(path))


def failing_writes(home: Path, expected: bytes, stride: int) -> Iterator[tuple[str, str, str]]:
    """Fault, outcome and words, for every write of a first run and of one that finds everything there."""
    failing = Failing()
    for code, forever in ((errno.ENOSPC, True), (errno.EIO, False)):
        for begun in ("first", "second"):
            for number in range(0, 10_000, stride):
                shutil.rmtree(home / "out", ignore_errors=True)
                if begun == "second":
                    shutil.copytree(home / "kept", home / "out")
                became, words = "", ""
                with failing.at(home / "out", number, code, forever=forever):
                    try:
                        result = ran(home)[1]
                        became = "harmless" if result == expected else "silent"
                    except InputError as error:
                        became, words = "refused", str(error)
                    except Exception as error:
                        became, words = "crash", f"write {number}: {type(error).__name__}: {error}"
                    reached = failing.count > number
                if not reached:
                    break
                if became != "crash":
                    after, more = outcome(home, expected)
                    if after in (*FAULTS, "refused"):
                        became, words = "crash", f"write {number}, {words!r}; afterwards {after}: {more}"
                yield f"{begun} run, {errno.errorcode[code]}{' from' if forever else ' at'} a write", became, words


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--faults", nargs="*", default=["bytes", "files", "writes"], choices=["bytes", "files", "writes"])
    parser.add_argument("--bytes", type=int, default=400)
    parser.add_argument("--stride", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--work", type=Path)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        home = (args.work or Path(scratch)).absolute()
        scans(home / "scans")
        _, expected = ran(home)
        shutil.copytree(home / "out", home / "kept")
        rng, outcomes = random.Random(args.seed), list[tuple[str, str, str]]()
        store = home / "kept" / "store"
        damages = [*flips(store, args.bytes, rng)] if "bytes" in args.faults else []
        damages += [*changes(store)] if "files" in args.faults else []
        for fault, put in damages:
            shutil.rmtree(home / "out")
            shutil.copytree(home / "kept", home / "out")
            put(home / "out" / "store")
            outcomes.append((fault, *outcome(home, expected)))
        outcomes += failing_writes(home, expected, args.stride) if "writes" in args.faults else []
    counts = Counter((fault, became) for fault, became, _ in outcomes)
    kinds = ("harmless", "mended", "told", "refused", *FAULTS)
    print("| fault | " + " | ".join(kinds) + " |\n|" + "---|" * (len(kinds) + 1))
    for fault in dict.fromkeys(fault for fault, _, _ in outcomes):
        print(f"| {fault} | " + " | ".join(str(counts[fault, became]) for became in kinds) + " |")
    bad = [row for row in outcomes if row[1] in FAULTS]
    print(f"{len(outcomes)} faults, {len(bad)} silent or a crash")
    for fault, became, words in dict.fromkeys((fault, became, words) for fault, became, words in bad):
        print(f"{fault}: {became}: {words}")
    for words in dict.fromkeys(words for _, became, words in outcomes if became == "refused"):
        print(f"refused: {words}")


if __name__ == "__main__":
    main()
