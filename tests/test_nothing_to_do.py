"""What kinetree imports where there is nothing to compute: no library that computes, stores, draws or starts workers."""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from shapes import sphere

from kinetree.pipeline.storage.files import SETTLED_SECONDS

COMPUTING = {
    "bokeh", "dask", "distributed", "matplotlib", "networkx", "numba", "obstore", "scipy", "skimage", "trimesh", "zarr",
}  # fmt: skip
"""Libraries that take seconds to import, together."""
FRAMES = 3
COMMAND = """
import atexit, sys
atexit.register(lambda: print("modules:", *sys.modules, file=sys.stderr))
from kinetree.tasks.application import main
main()
"""


def packed(folder: Path) -> Path:
    """Frames of a ball that grows, in one npz file."""
    V, F = sphere(1)
    offsets = {"vertex_offsets": np.arange(FRAMES + 1) * len(V), "face_offsets": np.arange(FRAMES + 1) * len(F)}
    vertices = np.concatenate([V * (1 + 0.1 * t) for t in range(FRAMES)])
    np.savez(folder / "balls.npz", vertices=vertices, faces=np.tile(F, (FRAMES, 1)), **offsets)
    return folder / "balls.npz"


def files(folder: Path) -> Path:
    """The same, one OFF file a frame."""
    V, F = sphere(1)
    (folder / "balls").mkdir()
    for t in range(FRAMES):
        rows = [f"OFF\n{len(V)} {len(F)} 0"]
        rows += [" ".join(map(str, (1 + 0.1 * t) * p)) for p in V]
        rows += [" ".join(map(str, [3, *face])) for face in F]
        (folder / "balls" / f"{t}.off").write_text("\n".join(rows) + "\n")
    return folder / "balls"


def imported(*arguments: str) -> set[str]:
    """The modules that a command has imported when it ends."""
    done = subprocess.run([sys.executable, "-c", COMMAND, *arguments], capture_output=True, text=True, timeout=300, check=True)
    return set(done.stderr.split("modules:")[1].split())


@pytest.mark.parametrize("written", [files, packed])
def test_commands_that_compute_nothing_import_no_library_that_computes(written, tmp_path):
    output, source = tmp_path / "out", written(tmp_path)
    time.sleep(SETTLED_SECONDS + 0.1)  # nothing is remembered of files that were written just now
    begin = ["--input", str(source), "--output", str(output), "--until", "mesh"]
    assert "scipy" in imported("run", *begin, "--quiet"), "there was something to compute"
    whole = ["plan", "--input", str(source), "--output", str(output)]
    for command in (
        ["run", *begin, "--quiet"],
        ["plan", *begin],
        whole,
        ["runs", str(output)],
        ["config", str(output)],
        ["tasks"],
    ):
        modules = imported(*command)
        assert "kinetree.schemas.input.mesh" in modules, command
        assert not modules & COMPUTING, command
        assert not [m for m in modules if m.startswith("kinetree.tasks.numerics.registration")], command
    assert json.loads((output / "run.json").read_text())["nodes"]["ran"] == 0
