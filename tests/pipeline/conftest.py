"""The toy graph as a package that a test may edit, over a folder of frames that it may change."""

import contextlib
import importlib
import json
import os
import secrets
import shutil
import signal
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from distributed import LocalCluster
from pipeline.toy_clusters import NONE

from kinetree.pipeline.identity.own_code import forget_code
from kinetree.pipeline.inspect import Pipeline

HERE = Path(__file__).parent
MAIN = """from kinetree.pipeline.application import Application, Section, Shortcut, built_in
from kinetree.pipeline.command_line.cli import main
NAMES = "run plan dataset show why graph tasks runs diff config gc verify"
COMMANDS = tuple(map(built_in, NAMES.split()))
INPUT = Shortcut(("--input",), "source.input", "Where the numbers are.", is_input=True)
def methods():
    from .toys import GRAPH
    return {"toy": GRAPH}
def data_sets():
    from .toy_datasets import GRAPH
    return GRAPH
TOY = Application("toy", "Adds numbers.", methods, None, (Section("All", COMMANDS),), (INPUT,), data_sets)
if __name__ == "__main__":
    main(TOY)
"""
"""Another product on the loom: it has nothing of kinetree's."""


@dataclass
class Heard:
    """A listener that keeps every event."""

    events: list[dict[str, Any]] = field(default_factory=list)

    def hear(self, event: dict[str, Any]) -> None:
        """One event."""
        self.events.append(event)

    def nodes(self, kind: str) -> list[str]:
        """Labels of the nodes of which this was told."""
        return [e["node"] for e in self.events if e["event"] == kind]


@dataclass
class Run:
    """One run in this process: what it returned, what was heard."""

    told: dict[str, Any]
    heard: Heard

    @property
    def ran(self) -> set[str]:
        """Labels of the nodes that were computed."""
        computed = self.heard.nodes("finish")
        assert len(computed) == len(set(computed)), "a node was computed twice"
        return set(computed)

    @property
    def counts(self) -> dict[str, int]:
        """How many nodes of each task were computed."""
        return dict(Counter(node.partition("[")[0] for node in self.ran))


@dataclass
class Toys:
    """The toy package, its frames, its flags and its store."""

    folder: Path
    name: str
    frames: Path
    flags: Path
    log: Path
    output: Path
    main: str = "toys"
    """The module of the package that has the graph."""
    started: "list[subprocess.Popen[str]]" = field(default_factory=list)

    @property
    def module(self) -> ModuleType:
        """The module that has the graph, as it is written now."""
        return importlib.import_module(f"{self.name}.{self.main}")

    def edit(self, old: str, new: str, file: str = "toys.py") -> None:
        """Replaces text in the source and forgets what was loaded of it."""
        path = self.folder / self.name / file
        text = path.read_text()
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in {file}"
        path.write_text(text.replace(old, new))
        self.forget()

    def forget(self) -> None:
        """Makes the next import read the source again, as a new process would."""
        for module in [m for m in sys.modules if m.partition(".")[0] == self.name]:
            del sys.modules[module]
        importlib.invalidate_caches()
        forget_code()

    def write(self, *numbers: float, start: int = 0) -> None:
        """Writes one frame per number, from frame `start` on."""
        for frame, number in enumerate(numbers, start):
            (self.frames / f"{frame:05d}.txt").write_text(f"{number}")

    def flag(self, name: str) -> Path:
        """Raises a flag such as fail-points-30."""
        path = self.flags / name
        path.touch()
        return path

    def config(self, **blocks: Any) -> dict[str, Any]:
        """A configuration: synchronous unless told otherwise, blocks of parameters by task."""
        whole = {"output": str(self.output), "compute": {"executor": "sync"}, **blocks}
        whole["source"] = {"input": str(self.frames), **blocks.get("source", {})}
        return whole

    def pipeline(self, **blocks: Any) -> Pipeline:
        """The toy graph over the frames."""
        return Pipeline.of(self.config(**blocks), methods={"toy": self.module.GRAPH})

    def run(self, client: Any = None, *, until: tuple[str, ...] = (), force: tuple[str, ...] = (), **blocks: Any) -> Run:
        """Runs in this process and keeps what was heard."""
        heard = Heard()
        account = self.pipeline(**blocks).run(client, until=until, force=force, listeners=[heard])
        return Run(account, heard)

    def executions(self) -> list[str]:
        """What every process executed since the last `clear`, such as points-30, in the order of the log."""
        return self.log.read_text().split() if self.log.exists() else []

    def clear(self) -> None:
        """Forgets the executions so far."""
        self.log.unlink(missing_ok=True)

    def artifacts(self, **blocks: Any) -> dict[str, str | None]:
        """The artifact digest of every node, as a plan tells it."""
        return {n.node: n.artifact for n in self.pipeline(**blocks).plan().nodes}

    def stored(self) -> dict[str, bytes]:
        """Every file of the store, byte for byte."""
        store = self.output / "store"
        return {str(f.relative_to(store)): f.read_bytes() for f in sorted(store.rglob("*")) if f.is_file()}

    def yaml(self, **blocks: Any) -> Path:
        """The configuration as a file (JSON is YAML)."""
        path = self.folder / "config.yaml"
        path.write_text(json.dumps(self.config(**blocks)))
        return path

    def start(self, *arguments: str, deaf: bool = False, **options: Any) -> "subprocess.Popen[str]":
        """The command kinetree on the toy graph, in a process of its own, in a group of its own.

        deaf : it ignores SIGINT from its start, as what nohup or a shell's background starts; else it does not, even where
               this very test run was started so: what a process handles is at its default in the program it executes
        """
        command = [sys.executable, "-m", self.name, *arguments]
        before = signal.signal(signal.SIGINT, signal.SIG_IGN if deaf else signal.default_int_handler)
        try:
            process = subprocess.Popen(
                command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True, **options
            )
        finally:
            signal.signal(signal.SIGINT, before)
        self.started.append(process)
        return process

    def end(self) -> None:
        """Ends what a failing test left running, with every process it started itself."""
        for process in self.started:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()

    def command(self, *arguments: str) -> "subprocess.CompletedProcess[str]":
        """The command kinetree on the toy graph, to its end."""
        process = self.start(*arguments)
        out, err = process.communicate(timeout=120)
        return subprocess.CompletedProcess(arguments, process.returncode, out, err)

    @staticmethod
    def until(condition: Callable[[], Any], what: str, *processes: "subprocess.Popen[str]") -> None:
        """Waits for a fact that other processes make true; gives up only where they ended without it."""
        for _ in range(6000):
            ended = all(process.poll() is not None for process in processes)
            if condition():
                return
            if processes and ended:
                break
            threading.Event().wait(0.01)
        told = [process.communicate()[1] for process in processes if process.poll() is not None]
        raise AssertionError(f"never happened: {what} {told}")


@pytest.fixture
def toys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Toys]:
    """Six frames with the numbers 10, 20, … 60 under the toy graph; worker processes find it through PYTHONPATH."""
    name = f"toys_{secrets.token_hex(6)}"
    package = tmp_path / "code" / name
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "__main__.py").write_text(MAIN)
    for file in ("toys.py", "toy_sums.py", "toy_passes.py", "toy_links.py", "toy_datasets.py"):
        shutil.copy(HERE / file, package / file)
    toy = Toys(package.parent, name, tmp_path / "frames", tmp_path / "flags", tmp_path / "log", tmp_path / "out")
    toy.frames.mkdir()
    toy.flags.mkdir()
    toy.write(10, 20, 30, 40, 50, 60)
    monkeypatch.syspath_prepend(str(toy.folder))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(toy.folder), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep))
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setenv("TOYS_LOG", str(toy.log))
    monkeypatch.setenv("TOYS_FLAGS", str(toy.flags))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    yield toy
    toy.end()
    with contextlib.suppress(ImportError):
        toy.forget()


@pytest.fixture
def empty(toys: Toys) -> Iterator[LocalCluster]:
    """A cluster that has no worker yet; its workers find the toys."""
    with LocalCluster(**NONE) as cluster:
        yield cluster
