"""A data set night after night: what a first run, a night without news, new and changed takes, kills and twins cost.

    python benchmarks/dataset.py [--sequences 50] [--distinct 50] [--frames 3] [--vertices 600] [--small 8]
    python benchmarks/dataset.py --parts workers --sequences 50 --frames 2 --vertices 600 [--executor processes]

The second line computes 45 bodies three times: by one worker, by two, and by two commands of one worker at once. It needs a
machine with nothing else to do: about 7 minutes on two cores.

Prints one table. Every sequence is a generated body of other proportions: humans, quadrupeds and random trees in turn; five
are broken in different ways. Nodes are counted in dataset.log. Kills and
twins are tried on `--small` sequences, one worker against two on all that are not broken.
"""

import argparse
import itertools
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from accuracy import MOTIONS, varied

from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.input.synth import write_sequence

FIGURES = ("human", "quadruped", "random")
PARTS = ("nights", "workers", "faults")
CONFIG = {"sequences": "takes/*", "output": "results/{name}", "truth": {"file": "{input}/truth.json"}}
KINETREE = [sys.executable, "-c", "from kinetree.tasks.application import main; main()", "dataset"]


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--sequences", type=int, default=50, help="sequences, five of them broken")
    options.add_argument("--frames", type=int, default=3)
    options.add_argument("--vertices", type=int, default=600, help="a bird of 300 has lost its wings, as a grid so coarse has")
    options.add_argument(
        "--distinct", type=int, default=50, help="bodies of the first night; more sequences are copies of them"
    )
    options.add_argument("--small", type=int, default=8, help="sequences for kills and twins, at most 10")
    options.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="what is measured")
    options.add_argument("--executor", choices=("threads", "processes"), default="threads", help="of the part workers")
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        lab = Lab(Path(folder) / "lab", chosen.frames, chosen.vertices, chosen.distinct)
        parts = {
            "nights": lambda: _nights(lab, chosen.sequences),
            "workers": lambda: _workers(lab, chosen.sequences - 5, chosen.executor),
            "faults": lambda: _faults(lab, chosen.small),
        }
        for what, *cells in itertools.chain.from_iterable(parts[part]() for part in chosen.parts):
            print(f"{what:<44}" + "".join(f"{cell!s:>26}" for cell in cells), flush=True)


class Lab:
    """A folder of takes and the file that describes them."""

    def __init__(self, home: Path, frames: int, vertices: int, distinct: int) -> None:
        self.home, self._frames, self._vertices, self._distinct = home, frames, vertices, distinct
        (home / "takes").mkdir(parents=True)
        self._seed = 0
        self.file = self.write(home / "lab.yaml", CONFIG)

    @staticmethod
    def write(path: Path, keys: dict[str, Any]) -> Path:
        """Writes a data set's file."""
        path.write_text(json.dumps(keys))
        return path

    def take(self, name: str, copy_of: int | None = None) -> Path:
        """Generates a body that no other take has, or copies the first ones in turn."""
        folder = self.home / "takes" / name
        shutil.rmtree(folder, ignore_errors=True)
        if copy_of is not None and copy_of >= self._distinct:
            return Path(shutil.copytree(self.home / "takes" / f"take_{copy_of % self._distinct:03d}", folder))
        self._seed += 1
        figure = FIGURES[self._seed % len(FIGURES)]
        options = {"figure": f"random:{self._seed}", "frames": self._frames, "vertices": self._vertices, "seed": self._seed}
        if figure in MOTIONS:
            file = self.home / "figures" / f"{figure}_{self._seed}.yaml"
            file.parent.mkdir(exist_ok=True)
            file.write_text(json.dumps(varied(figure, self._seed)))  # which is YAML too
            options |= {"file": str(file), "motion": MOTIONS[figure][self._seed % len(MOTIONS[figure])]}
        write_sequence(SynthParams.model_validate({**options, "connectivity": "fixed"}), folder)
        return folder

    def broken(self) -> None:
        """Five takes, each wrong in another way."""
        (self.home / "takes" / "broken_empty").mkdir()
        torn = self.take("broken_bytes")
        for file in torn.glob("*.ply"):
            file.write_bytes(b"ply, or so it says")
        single = self.take("broken_single")
        for file in sorted(single.glob("*.ply"))[1:]:
            file.unlink()
        (self.take("broken_truth") / "truth.json").write_text("{")
        text = self.take("broken_faces")
        for file in text.glob("*.ply"):
            file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])

    def run(self, file: Path | None = None, *options: str) -> tuple[dict[str, Any], float, float]:
        """What a run tells, its seconds by the clock and of the processor."""
        before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run([*KINETREE, "run", str(file or self.file), "--json", *options], capture_output=True, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode not in (0, 1):
            raise SystemExit(done.stderr.decode())
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return json.loads(done.stdout), time.perf_counter() - started, spent

    def start(self, file: Path, *options: str) -> "subprocess.Popen[bytes]":
        """A run that goes on while others do."""
        return subprocess.Popen(
            [*KINETREE, "run", str(file), "--json", *options], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )


def computed(log: Path) -> Counter[tuple[str, str]]:
    """How often each node of each sequence was computed, by a log."""
    lines = (log.with_name(name).read_text().splitlines() for name in ("dataset.log",) if log.with_name(name).exists())
    events = (json.loads(line) for part in lines for line in part if line.startswith("{") and line.endswith("}"))
    return Counter((event["name"], event["node"]) for event in events if event["event"] == "finish")


def _cells(report: dict[str, Any], wall: float, spent: float, before: int, log: Path) -> list[str]:
    states = ", ".join(f"{count} {state}" for state, count in report["counts"].items() if count)
    return [states, f"{sum(computed(log).values()) - before} nodes", f"{spent:.1f} s, {wall:.1f} s wall"]


def _nights(lab: Lab, count: int) -> Iterator[list[str]]:
    yield ["run", "sequences", "nodes of sequences", "processor"]
    log = lab.home / "results" / "dataset.log"
    for number in range(count - 5):
        lab.take(f"take_{number:03d}", copy_of=number)
    lab.broken()
    yield ["the first", *_cells(*lab.run(), 0, log)]
    before = sum(computed(log).values())
    yield ["nothing new; five still broken", *_cells(*lab.run(), before, log)]
    for name in ("bytes", "empty", "faces", "single", "truth"):
        shutil.rmtree(lab.home / "takes" / f"broken_{name}")
    yield ["the broken ones removed", *_cells(*lab.run(), before, log)]
    yield ["nothing new", *_cells(*lab.run(), before, log)]
    for number in range(3):
        lab.take(f"take_{number:03d}")
    yield ["three changed", *_cells(*lab.run(), before, log)]
    before = sum(computed(log).values())
    for number in range(count, count + 6):
        lab.take(f"take_{number:03d}")
    yield ["six new", *_cells(*lab.run(), before, log)]


def _takes(lab: Lab, count: int) -> list[str]:
    """The first takes, generated where they are not there yet."""
    for number in range(count):
        if not (lab.home / "takes" / f"take_{number:03d}").exists():
            lab.take(f"take_{number:03d}", copy_of=number)
    return [f"takes/take_{number:03d}" for number in range(count)]


def _workers(lab: Lab, count: int, executor: str) -> Iterator[list[str]]:
    keys = {**CONFIG, "sequences": _takes(lab, count)}
    wall = {}
    for workers in (1, 2):
        file = lab.write(lab.home / f"workers_{workers}.yaml", {**keys, "output": f"workers_{workers}/{{name}}"})
        report, wall[workers], spent = lab.run(file, "--workers", str(workers), "--executor", executor)
        cells = _cells(report, wall[workers], spent, 0, lab.home / f"workers_{workers}" / "dataset.log")
        yield [f"{count} sequences, {executor}: {workers}", *cells]
        yield from (["", f"{n}: {row['failures']}"] for n, row in report["sequences"].items() if row["state"] == "failed")
    yield ["by the clock, 1 worker over 2", f"{wall[1] / wall[2]:.2f}"]
    yield ["  results equal", _equal(lab.home / "workers_1", lab.home / "workers_2")]
    yield from _two_commands(lab, keys, wall[1])


def _two_commands(lab: Lab, keys: dict[str, Any], alone: float) -> Iterator[list[str]]:
    """The same by two commands at once, which share the sequences; `alone` is what one worker takes, seconds by the clock."""
    file = lab.write(lab.home / "commands.yaml", {**keys, "output": "commands/{name}"})
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    reports = [json.loads(one.communicate()[0]) for one in [lab.start(file, "--workers", "1") for _ in range(2)]]
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - started
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    shares = " and ".join(f"{one['counts']['ran']}" for one in reports)
    nodes = sum(computed(lab.home / "commands" / "dataset.log").values())
    yield ["two commands at once, threads: 1 each", f"{shares} ran", f"{nodes} nodes", f"{spent:.1f} s, {wall:.1f} s wall"]
    yield ["by the clock, 1 worker over 2 commands", f"{alone / wall:.2f}"]
    yield ["  results equal", _equal(lab.home / "workers_1", lab.home / "commands")]


def _faults(lab: Lab, count: int) -> Iterator[list[str]]:
    keys = {**CONFIG, "sequences": _takes(lab, count)}
    file = lab.write(lab.home / "clean.yaml", {**keys, "output": "clean/{name}"})
    lab.run(file)
    clean = sum(computed(lab.home / "clean" / "dataset.log").values())
    file = lab.write(lab.home / "killed.yaml", {**keys, "output": "killed/{name}"})
    log, kills = lab.home / "killed" / "dataset.log", 0
    for share in sorted(random.Random(0).uniform(0.1, 0.9) for _ in range(3)):
        process = lab.start(file)
        while sum(computed(log).values()) < share * clean and process.poll() is None:
            time.sleep(0.05)
        if process.poll() is None:
            os.kill(process.pid, signal.SIGKILL)
            kills += 1
        process.communicate()
    report, _, _ = lab.run(file)
    yield [f"killed {kills} times, then run", report["status"], f"{sum(computed(log).values())} of {clean}", _twice(log)]
    yield ["  results equal to the undisturbed", _equal(lab.home / "clean", lab.home / "killed")]
    file = lab.write(lab.home / "twins.yaml", {**keys, "output": "twins/{name}"})
    twins = [lab.start(file), lab.start(file)]
    shared = [json.loads(twin.communicate()[0])["counts"] for twin in twins]
    log = lab.home / "twins" / "dataset.log"
    shares = " and ".join(f"{counts['ran']}" for counts in shared)
    yield ["two at once", f"sequences: {shares}", f"{sum(computed(log).values())} of {clean}", _twice(log)]
    yield ["  results equal to the undisturbed", _equal(lab.home / "clean", lab.home / "twins")]


def _twice(log: Path) -> str:
    return f"{sum(n - 1 for n in computed(log).values())} computed twice"


def _equal(one: Path, other: Path) -> str:
    files = [f.relative_to(one) for f in one.glob("*/skeleton.*")] + [Path("summary.csv")]
    same = [f for f in files if f.name != "summary.csv" and (one / f).read_bytes() == (other / f).read_bytes()]
    rows = [_without_seconds(folder / "summary.json") for folder in (one, other)]
    return f"{len(same)} of {len(files) - 1} files; table {'equal' if rows[0] == rows[1] else 'different'}"


def _without_seconds(path: Path) -> list[dict[str, Any]]:
    return [{k: v for k, v in row.items() if k != "seconds"} for row in json.loads(path.read_text())["sequences"]]


if __name__ == "__main__":
    main()
