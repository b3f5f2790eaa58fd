"""The benchmark that fits constants of expected errors refuses at its start what could not be fitted hours later."""

import subprocess
import sys
from pathlib import Path

PATH = Path(__file__).resolve().parent.parent / "benchmarks" / "error_bars.py"


def test_bodies_of_too_few_frames_for_a_surface_offset_are_refused_before_any_is_computed() -> None:
    done = subprocess.run([sys.executable, str(PATH), "--frames", "7"], capture_output=True, text=True, timeout=100)
    assert (done.returncode, done.stdout) == (2, "")
    assert "--frames 7: constants are fitted to joints that have a surface offset, which need 8 frames" in done.stderr
