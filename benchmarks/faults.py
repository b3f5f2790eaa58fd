"""What a run says when its workers, its scheduler, its store or itself are killed, stopped, filled up or taken away.

    python benchmarks/faults.py [--moments 20] [--only WORD …] [--seed 0] [--log FILE]

One line for every cell of executor and fault, each tried at so many random moments of a run. A try is right if the run
called itself done and every artifact equals that of a run nobody disturbed, or if it ended with a documented exit code (or was
killed) and one more run made it so. It is wrong if a run was called done and was not, if it ended in any other way, or if
it was not over within BOUND seconds. The command exits with 1 if any try was wrong.

The toy graph has a chain of 24 frames, which travel in stretches, gathers and a fan-out that depends on data.

A full disk (a tmpfs) and a worker with another folder under the store's path (a mount namespace) need root; without it these
cells are left out and the table says so.
"""

import argparse
import contextlib
import itertools
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from flaky_service import FlakyService

BOUND = 240.0
"""Seconds in which a disturbed run must be over; a service that answers 503 is asked again for three minutes."""
STOPPED_SECONDS = 30.0
EXECUTORS = ("sync", "threads", "processes", "scheduler")
TOY = """
import hashlib
from collections.abc import Mapping
from typing import Annotated, ClassVar
import numpy as np
from kinetree.pipeline.application import Application, Section, built_in
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import origin, task
from kinetree.schemas.array import Array, Artifact, Floats, Index, Params
from kinetree.schemas.dims import VERTEX

class SourceParams(Params):
    count: int = 24

class Source(Artifact):
    number: int

class First(Artifact):
    x: Annotated[Floats, Array("float64", VERTEX)]

class Second(Artifact):
    x: Annotated[Floats, Array("float64", VERTEX)]

class Row(Artifact):
    def previous(self, member: int) -> int | None:
        return member - 1 if member else None

class Link(Artifact):
    x: Annotated[Floats, Array("float64", VERTEX)]

class Groups(Artifact):
    opens: ClassVar[tuple[str, ...]] = ("interval",)
    count: int
    def members(self, space: str, index: Index) -> tuple[int, ...]:
        return tuple(range(self.count))

class Part(Artifact):
    x: Annotated[Floats, Array("float64", VERTEX)]

class Total(Artifact):
    value: float

def worked(seed: int) -> np.ndarray:
    data = hashlib.pbkdf2_hmac("sha256", str(seed).encode(), b"", 10_000, 256)
    return np.tile(np.frombuffer(data, dtype=np.uint8).astype(float), 16)

@origin(over="frame")
def source(params: SourceParams, files: object) -> Mapping[int, Source]:
    return {n: Source(number=n) for n in range(params.count)}

@task(over="frame")
def first(source: Source) -> First:
    return First(x=worked(source.number))

@task(over="frame")
def second(first: First) -> Second:
    return Second(x=first.x + 1.0)

@task()
def row(source: tuple[Source, ...]) -> Row:
    return Row()

@task(over="frame", along=Row)
def link(first: First, before: Link | None) -> Link:
    return Link(x=worked(int(first.x.sum() + (before.x.sum() if before else 0.0))))

@task()
def groups(second: tuple[Second, ...]) -> Groups:
    return Groups(count=4 + int(sum(s.x.sum() for s in second)) % 3)

@task(over="interval")
def part(groups: Groups, first: tuple[First, ...], index: Index) -> Part:
    return Part(x=worked(index[0]) + sum(f.x for f in first))

@task()
def total(part: tuple[Part, ...], link: tuple[Link, ...]) -> Total:
    return Total(value=float(sum(p.x.sum() for p in (*part, *link))))

GRAPH = Graph.of((source, first, second, row, link, groups, part, total))
COMMANDS = tuple(map(built_in, ("run", "plan")))
APPLICATION = Application("faulty", "A graph to disturb.", lambda: {"toy": GRAPH}, sections=(Section("All", COMMANDS),))
"""
MAIN = """
from kinetree.pipeline.command_line.cli import main
from faulty.toy import APPLICATION
if __name__ == "__main__":
    main(APPLICATION)
"""


class OverError(Exception):
    """The run was over before it could be disturbed: another moment is tried."""


@dataclass
class Try:
    """One run and what disturbs it."""

    folder: Path
    executor: str
    rng: random.Random
    seconds: float
    """What an undisturbed run takes."""
    store: str = ""
    run: "subprocess.Popen[str] | None" = None
    lasting: "Lasting | None" = None
    """A cluster that serves many tries."""
    cluster: "Cluster | None" = None
    codes: tuple[int, ...] = (1, 2, 3)
    """Exit codes that are right for this fault."""
    ends: contextlib.ExitStack = field(default_factory=contextlib.ExitStack)

    def begin(self) -> None:
        """Starts the run, its scheduler first where it needs one."""
        self.store = self.store or str(self.folder / "out" / "store")
        if self.executor == "scheduler" and self.cluster is None:
            self.cluster = self.lasting.get() if self.lasting else self.own_cluster()
        self.run = self._command()

    def own_cluster(self, *before: str) -> "Cluster":
        """A cluster for this run alone, in the environment of now, its workers started by the command `before`."""
        self.cluster = Cluster(self.folder, *before)
        self.ends.callback(self.cluster.end)
        return self.cluster

    def again(self) -> "subprocess.Popen[str]":
        """One more run, undisturbed, on threads."""
        return self._command(executor="threads")

    def _command(self, executor: str = "") -> "subprocess.Popen[str]":
        chosen = executor or self.executor
        where = ["--executor", chosen, "--workers", "2"]
        if chosen == "scheduler":
            assert self.cluster is not None
            where = ["--scheduler-file", str(self.cluster.file), "--wait-workers", "1,20"]
        command = [
            sys.executable,
            "-m",
            "faulty",
            "run",
            "--quiet",
            "--output",
            str(self.folder / "out"),
            "--store",
            self.store,
        ]
        process = subprocess.Popen(
            [*command, *where], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        self.ends.callback(_kill_group, process)
        return process

    def wait(self, longest: float = 1.0) -> None:
        """Waits for a random moment of the run; raises OverError where the run was over before."""
        assert self.run is not None
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.run.wait(self.rng.uniform(0.0, longest * self.seconds))
            raise OverError

    def refuse_over(self) -> None:
        """Raises OverError where the run had said before now that it is done."""
        if (self.folder / "out" / "run.json").exists():
            raise OverError

    def workers(self) -> list[int]:
        """Process numbers of the workers that there are now."""
        assert self.run is not None
        above = self.run.pid if self.cluster is None else self.cluster.nanny.pid
        return [pid for pid in _below(above) if _is_worker(pid)]


class Cluster:
    """dask's own scheduler and worker commands, as somebody runs them."""

    def __init__(self, folder: Path, *before: str) -> None:
        file = self.file = folder / "scheduler.json"
        file.unlink(missing_ok=True)
        self.scheduler = _quietly(
            "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)
        )
        _until(file.exists)
        options = ("--nworkers", "2", "--nthreads", "1", "--no-dashboard", "--local-directory", str(folder / "scratch"))
        self.nanny = _quietly("distributed.cli.dask_worker", "--scheduler-file", str(file), *options, before=before)

    def end(self) -> None:
        """Ends all of it."""
        for process in (self.nanny, self.scheduler):
            _kill_group(process)


@dataclass
class Lasting:
    """A cluster, started anew where somebody ended it."""

    folder: Path
    cluster: Cluster | None = None

    def get(self) -> Cluster:
        """The cluster, there or started."""
        if self.cluster is not None and any(p.poll() is not None for p in (self.cluster.nanny, self.cluster.scheduler)):
            self.close()
        if self.cluster is None:
            self.folder.mkdir(exist_ok=True)
            self.cluster = Cluster(self.folder)
        return self.cluster

    def close(self) -> None:
        """Ends it."""
        if self.cluster is not None:
            self.cluster.end()
        self.cluster = None


def kill_worker(one: Try) -> None:
    """SIGKILL to one worker process."""
    one.begin()
    one.wait()
    _signal(one, signal.SIGKILL)


def stop_worker(one: Try) -> None:
    """SIGSTOP to one worker process, SIGCONT after 30 s."""
    one.begin()
    one.wait()
    for pid in _signal(one, signal.SIGSTOP):
        threading.Event().wait(STOPPED_SECONDS)
        _send(pid, signal.SIGCONT)


def kill_scheduler(one: Try) -> None:
    """SIGKILL to the scheduler."""
    one.begin()
    one.wait()
    assert one.cluster is not None
    one.cluster.scheduler.kill()


def stop_scheduler(one: Try) -> None:
    """SIGSTOP to the scheduler, SIGCONT after 30 s."""
    one.begin()
    one.wait()
    assert one.cluster is not None
    one.cluster.scheduler.send_signal(signal.SIGSTOP)
    threading.Event().wait(STOPPED_SECONDS)
    one.cluster.scheduler.send_signal(signal.SIGCONT)


def kill_run(one: Try) -> None:
    """SIGKILL to the run's own process; its workers are left to themselves."""
    one.begin()
    one.wait()
    assert one.run is not None
    one.run.kill()


def delete_store(one: Try) -> None:
    """The store's folder deleted."""
    one.begin()
    one.wait()
    one.refuse_over()
    shutil.rmtree(one.folder / "out" / "store", ignore_errors=True)


def fill_disk(one: Try) -> None:
    """The store on a device with room for a part of it; before the next run it grows."""
    place = one.folder / "disk"
    place.mkdir()
    size = one.rng.randint(64, 1100)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", str(place)], check=True)
    one.ends.callback(subprocess.run, ["umount", "-l", str(place)], check=False)
    one.store = str(place / "store")
    one.begin()
    _over(one)
    subprocess.run(["mount", "-o", "remount,size=64m", str(place)], check=True)


def other_folder(one: Try) -> None:
    """A worker that sees another folder under the store's path; before the next run it is gone."""
    store = one.folder / "out" / "store"
    other = one.folder / "other"
    for path in (store, other):
        path.mkdir(parents=True)
    mount = f'mount --bind "{other}" "{store}" && exec "$@"'
    one.own_cluster("unshare", "--mount", "sh", "-c", mount, "sh")
    one.begin()


def failing_service(status: int, share: float) -> Callable[[Try], None]:
    """From a random moment on, a service of S3 that answers this share of requests with an error."""

    def fault(one: Try) -> None:
        service = one.ends.enter_context(_service(one.rng.getrandbits(32)))
        one.store = f"s3://{service.bucket}/store"
        if one.executor == "scheduler":
            one.own_cluster()  # its workers need the address of the service
        one.begin()
        one.wait()
        service.status, service.share = status, share
        one.codes = (3,) if status >= 500 else (2,)
        _over(one)
        service.share = 0.0

    return fault


@contextlib.contextmanager
def _service(seed: int) -> Iterator[FlakyService]:
    service = FlakyService(seed)
    before = {name: os.environ.get(name) for name in service.environment}
    os.environ.update(service.environment)
    try:
        yield service
    finally:
        for name, value in before.items():
            os.environ.pop(name)
            os.environ.update({} if value is None else {name: value})
        service.end()


CELLS: tuple[tuple[str, Callable[[Try], None], tuple[str, ...], int | None], ...] = (
    ("kill -9 of a worker", kill_worker, ("processes", "scheduler"), None),
    ("kill -9 of the scheduler", kill_scheduler, ("scheduler",), None),
    ("kill -9 of the run", kill_run, EXECUTORS, None),
    ("store deleted", delete_store, EXECUTORS, None),
    ("disk full", fill_disk, EXECUTORS, None),
    ("worker stopped for 30 s", stop_worker, ("processes", "scheduler"), 2),
    ("scheduler stopped for 30 s", stop_scheduler, ("scheduler",), 2),
    ("another folder under the store's path", other_folder, ("scheduler",), 2),
    ("S3: 503 to a third of requests", failing_service(503, 0.33), ("threads", "processes", "scheduler"), 2),
    ("S3: 500 to a third of requests", failing_service(500, 0.33), ("threads", "processes", "scheduler"), 2),
    ("S3: 403 to every request", failing_service(403, 1.0), ("threads", "processes", "scheduler"), 2),
    ("S3: 503 to every request", failing_service(503, 1.0), ("threads",), 1),
)
"""Fault, what makes it, on which executors, and how many moments where they are not as many as asked for."""


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--moments", type=int, default=20, help="tries of each cell; those that take minutes have fewer")
    options.add_argument("--only", nargs="*", default=[], help="cells whose fault or executor has one of these words")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--log", type=Path, help="file of tries, one a line, to which this run adds")
    options.add_argument("--keep", type=Path, help="folder for the runs of tries that were wrong")
    chosen = options.parse_args()
    print("| fault | executor | tries | done and equal | stopped, by exit code | equal after one more run | wrong |")
    print("|---|---|---|---|---|---|---|", flush=True)
    cells = [(name, fault, e, most) for name, fault, executors, most in CELLS for e in executors]
    cells = [c for c in cells if not chosen.only or any(word in f"{c[0]} {c[2]}" for word in chosen.only)]
    tries = Tries(chosen.log)
    with tempfile.TemporaryDirectory() as top, contextlib.closing(Lasting(Path(top) / "cluster")) as lasting:
        if chosen.moments:
            needed = [e for e in EXECUTORS if e == "sync" or any(c[2] == e for c in cells)]
            expected, seconds = _calm(Path(top), needed)
        numbers = itertools.count()
        for name, fault, executor, most in cells:
            if os.geteuid() and fault in (fill_disk, other_folder):
                print(f"| {name} | {executor} | needs root | | | | |", flush=True)
                continue
            counts = tries.of(name, executor)
            moments = random.Random(f"{chosen.seed} {name} {executor} {counts['tries']}")
            while counts["tries"] < min(chosen.moments, most or chosen.moments):
                one = Try(Path(top) / f"try{next(numbers)}", executor, moments, seconds[executor], lasting=lasting)
                with contextlib.suppress(OverError):
                    tries.add(name, executor, _tried(one, fault, expected, chosen.keep))
            if counts["tries"]:
                print(_row(name, executor, counts), flush=True)
    raise SystemExit(any(counts["wrong"] for counts in tries.of_cell.values()))


def _row(name: str, executor: str, counts: Counter[str]) -> str:
    codes = ", ".join(f"{n} × {c.removeprefix('exit ')}" for c, n in sorted(counts.items()) if c.startswith("exit "))
    row = (name, executor, counts["tries"], counts["done"], codes or "–", counts["again"], counts["wrong"])
    return f"| {' | '.join(map(str, row))} |"


class Tries:
    """What became of tries, by fault and executor, and the file in which they are noted."""

    def __init__(self, log: Path | None) -> None:
        self.log = log
        self.of_cell: dict[tuple[str, str], Counter[str]] = {}
        for line in log.read_text().splitlines() if log is not None and log.exists() else []:
            name, executor, outcome = json.loads(line)
            self.of(name, executor).update(outcome)

    def of(self, name: str, executor: str) -> Counter[str]:
        """The tries of one cell; they grow as tries are added."""
        return self.of_cell.setdefault((name, executor), Counter())

    def add(self, name: str, executor: str, outcome: Counter[str]) -> None:
        """Counts one try and notes it."""
        self.of(name, executor).update(outcome)
        if self.log is not None:
            with self.log.open("a") as file:
                file.write(json.dumps([name, executor, outcome]) + "\n")


def _calm(top: Path, executors: list[str]) -> tuple[dict[str, str | None], dict[str, float]]:
    """What a run makes that nobody disturbs, and how long it takes on each executor."""
    package = top / "code" / "faulty"
    package.mkdir(parents=True)
    for name, text in {"__init__.py": "", "toy.py": TOY, "__main__.py": MAIN}.items():
        (package / name).write_text(text)
    sys.path.insert(0, str(package.parent))
    os.environ["PYTHONPATH"] = os.pathsep.join([str(package.parent), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)
    seconds, artifacts = {}, {}
    for executor in executors:
        one = Try(top / executor, executor, random.Random(0), 0.0)
        one.folder.mkdir()
        with one.ends:
            started = time.monotonic()
            one.begin()
            assert _over(one) == (0, ""), "a run that nobody disturbs"
            seconds[executor] = time.monotonic() - started
            artifacts[executor] = _artifacts(one)
    assert all(of_executor == artifacts["sync"] for of_executor in artifacts.values())
    return artifacts["sync"], seconds


def _tried(one: Try, fault: Callable[[Try], None], expected: dict[str, str | None], keep: Path | None) -> Counter[str]:
    one.folder.mkdir()
    counts = Counter(["tries"])
    with contextlib.ExitStack() as stack:
        stack.callback(shutil.rmtree, one.folder, ignore_errors=True)
        stack.enter_context(one.ends)
        fault(one)
        code, message = last = _over(one)
        if code == 0:
            counts["done" if _artifacts(one) == expected else "wrong"] += 1
        elif code == -signal.SIGKILL and fault is kill_run:
            counts["exit killed"] += 1
        elif code in one.codes and message.startswith("faulty: ") and "Traceback" not in message:
            counts[f"exit {code}"] += 1
        else:
            counts["wrong"] += 1
        if code != 0 and not counts["wrong"]:
            last = _ended(one.again())
            counts["again" if last[0] == 0 and _artifacts(one) == expected else "wrong"] += 1
        if counts["wrong"]:
            print(f"{fault.__name__}, {one.executor}: {code} {message}, then {last}", file=sys.stderr, flush=True)
            if keep is not None:
                shutil.copytree(one.folder, keep / one.folder.name, dirs_exist_ok=True)
    return counts


def _over(one: Try) -> tuple[int | str, str]:
    assert one.run is not None
    return _ended(one.run)


def _ended(process: "subprocess.Popen[str]") -> tuple[int | str, str]:
    """Exit code and message of a run, "hangs" where it does not end; asked again it says the same."""
    try:
        _, err = process.communicate(timeout=BOUND)
    except subprocess.TimeoutExpired:
        return "hangs", ""
    except ValueError:  # its message was read before
        err = getattr(process, "message", "")
    process.message = err  # type: ignore[attr-defined]
    return process.returncode, err


def _artifacts(one: Try) -> dict[str, str | None]:
    """The artifact of every node that is there, as a plan in this process finds it."""
    from faulty.toy import APPLICATION  # type: ignore[import-not-found]

    from kinetree.pipeline.inspect import Pipeline

    plan = Pipeline.of({"output": str(one.folder / "out"), "store": one.store}, application=APPLICATION).plan()
    return {node.node: node.artifact if node.state == "fresh" else None for node in plan.nodes}


def _signal(one: Try, number: signal.Signals) -> list[int]:
    """Sends a signal to a worker and returns which; raises OverError where there is none."""
    workers = one.workers()
    signalled = [pid for pid in [one.rng.choice(workers)] if _send(pid, number)] if workers else []
    if not signalled:
        raise OverError
    return signalled


def _send(pid: int, number: signal.Signals) -> bool:
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        return False
    return True


def _below(pid: int) -> list[int]:
    """The processes that a process started, and those that these did."""
    children: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            one = int(stat.parent.name)
            children.setdefault(_parent(one), []).append(one)
    descendants = list(children.get(pid, []))
    for child in descendants:
        descendants += children.get(child, [])
    return descendants


def _is_worker(pid: int) -> bool:
    """Whether a process is a worker of dask and not its nanny, what it is forked from or what watches over semaphores."""
    with contextlib.suppress(OSError):
        command = Path(f"/proc/{pid}/cmdline").read_bytes()
        return b"spawn_main" in command or (
            b"forkserver" in command and command == Path(f"/proc/{_parent(pid)}/cmdline").read_bytes()
        )
    return False


def _parent(pid: int) -> int:
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


def _quietly(module: str, *options: str, before: tuple[str, ...] = ()) -> "subprocess.Popen[str]":
    command = [*before, sys.executable, "-m", module, *options]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True, start_new_session=True)


def _kill_group(process: "subprocess.Popen[str]") -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _until(fact: Callable[[], bool]) -> None:
    until = time.monotonic() + 60
    while not fact():
        assert time.monotonic() < until
        time.sleep(0.05)


if __name__ == "__main__":
    main()
