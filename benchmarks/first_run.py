"""What compiling kernels costs the first run on a machine: the demo, alone and with a process that compiles ahead.

    python benchmarks/first_run.py [--times 1] [--record]

Prints seconds by the clock and of processor time of the whole command: with no kernel on disk and nothing compiled ahead, with
none and the process ahead, with all on disk. `--record` runs the demo in this process instead and writes the list of kernels
that the process ahead compiles.
"""

import argparse
import contextlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from numba.core import event

from kinetree.tasks.compiled_ahead import SWITCH
from kinetree.tasks.numerics.kernel_list import LIST, text_of


def main() -> None:
    """Prints the table, or writes the list."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--times", type=int, default=1)
    options.add_argument("--record", action="store_true")
    chosen = options.parse_args()
    if chosen.record:
        record()
        return
    print(f"{'kernels':<34}{'clock, s':>10}{'processor, s':>14}")
    for _ in range(chosen.times):
        with tempfile.TemporaryDirectory() as warm, tempfile.TemporaryDirectory() as other:
            runs = (("none on disk", warm, "0"), ("none, compiled ahead", other, "1"), ("all on disk", warm, "0"))
            for what, folder, ahead in runs:
                clock, processor = timed({"NUMBA_CACHE_DIR": folder, SWITCH: ahead})
                print(f"{what:<34}{clock:>10.1f}{processor:>14.1f}", flush=True)


def timed(environment: dict[str, str]) -> tuple[float, float]:
    """Seconds of the demo, into a new folder: by the clock, and of the processor with all its processes."""
    with tempfile.TemporaryDirectory() as folder:
        before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        command = [str(Path(sys.executable).with_name("kinetree")), "demo", "--output", f"{folder}/demo"]
        silent = subprocess.DEVNULL
        subprocess.run(command, env={**os.environ, **environment}, check=True, stdout=silent, stderr=silent)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.perf_counter() - begun, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def record() -> None:
    """Runs the demo with no kernel on disk and writes every kernel that Python called, in the order of first calls."""
    signatures: dict[str, None] = {}
    with tempfile.TemporaryDirectory() as folder:
        os.environ |= {"NUMBA_CACHE_DIR": folder, SWITCH: "0"}
        event.register("numba:compile", _Calls(signatures))
        from kinetree.pipeline.command_line.options import pipeline_of

        pipeline_of("demo", output=f"{folder}/demo").run()
    LIST.write_text("".join(f"{line}\n" for line in signatures), encoding="utf-8")


class _Calls(event.Listener):  # type: ignore[misc]
    """Notes compilations that no other compilation asked for."""

    def __init__(self, signatures: dict[str, None]) -> None:
        self.signatures = signatures
        self.depth = 0

    def on_start(self, event: Any) -> None:
        """Notes the kernel with the types of its arguments."""
        self.depth += 1
        function = event.data["dispatcher"].py_func
        if self.depth == 1 and function.__module__.startswith("kinetree."):
            with contextlib.suppress(TypeError):  # a record, or what else has no text, is compiled when it is called
                types = [text_of(kind) for kind in event.data["args"]]
                self.signatures.setdefault(json.dumps([f"{function.__module__}.{function.__qualname__}", types]))

    def on_end(self, event: Any) -> None:
        """Goes back to the compilation that asked for this one."""
        self.depth -= 1


if __name__ == "__main__":
    main()
