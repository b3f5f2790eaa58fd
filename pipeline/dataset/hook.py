"""The program that hears of failures."""

import subprocess

SECONDS = 600.0
"""How long it may take."""


def called(command: list[str]) -> str:
    """Calls a program without a shell; returns what became of it."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"{command[0]}: {error}"
    last = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
    return f"{command[0]}: exit code {done.returncode}{f': {last}' if done.returncode and last else ''}"
