"""Benchmarks start: each finds what it imports of the product, of other benchmarks and of the packages for tests."""

import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
IMPORT = "import importlib, sys; sys.path.insert(0, sys.argv[1]); [importlib.import_module(name) for name in sys.argv[2:]]"


def test_every_benchmark_finds_what_it_imports():
    names = sorted(path.stem for path in FOLDER.glob("*.py"))
    assert "simulate" in names
    done = subprocess.run([sys.executable, "-c", IMPORT, str(FOLDER), *names], capture_output=True, text=True, timeout=100)
    assert (done.returncode, done.stderr) == (0, "")
