"""Meshes that Draco has packed: unpacked in a process of their own, whose memory and time are bounded.

A few kilobytes of Draco may unpack to gigabytes, and no header bounds them: a face takes no bits where all are alike.
"""

import os
import subprocess
import sys
from importlib.util import find_spec
from io import BytesIO

import numpy as np

from kinetree.errors import MeshError
from kinetree.tasks.numerics.arrays import Floats, Ints

MOST_MEMORY = 4 * 2**30
"""Bytes that unpacking may take: forty million faces take as much, a body of 100,000 some 10 MB."""
MOST_SECONDS = 60
"""Processor time that it may take: of the same faces about a quarter."""
MOST_BYTES = 2**28
"""Of vertices and faces as they come back, some ten million faces: here they are held again, and as wider numbers."""
_TOO_LARGE = 3
_UNPACK = """
import resource, sys
memory, seconds, most, too_large = map(int, sys.argv[1:])
resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
from io import BytesIO
import DracoPy, numpy
mesh = DracoPy.decode(sys.stdin.buffer.read())
arrays = [numpy.asarray(mesh.points), numpy.asarray(getattr(mesh, "faces", ()))]
size = sum(array.nbytes for array in arrays)
if size > most:
    print(f"unpack to {size} bytes, more than {most}", file=sys.stderr)
    sys.exit(too_large)
held = BytesIO()
for array in arrays:
    numpy.save(held, array, allow_pickle=False)
sys.stdout.buffer.write(held.getbuffer())
"""


def unpacked(raw: bytes) -> tuple[Floats, Ints]:
    """The mesh of a .drc file; without faces where it is a point cloud.

    returns : V (vertex, xyz) in the file's unit · F (face, corner)
    raises  : MeshError where DracoPy is not installed, refuses it, or takes more memory or time than it may
    """
    if find_spec("DracoPy") is None:
        raise MeshError("Draco is read by DracoPy; pip install 'kinetree[draco]'")
    command = [sys.executable, "-P", "-c", _UNPACK, *map(str, (MOST_MEMORY, MOST_SECONDS, MOST_BYTES, _TOO_LARGE))]
    one_thread = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # every thread sets memory aside
    done = subprocess.run(command, input=raw, capture_output=True, check=False, env=one_thread)
    last = done.stderr.decode("utf-8", "replace").strip().rpartition("\n")[2]
    if done.returncode < 0 or "MemoryError" in last or "bad_alloc" in last:
        limits = f"{MOST_MEMORY // 2**30} GB and {MOST_SECONDS} s"
        raise MeshError(f"its {len(raw)} bytes are not unpacked within {limits}; the file is damaged or no mesh of a body")
    if done.returncode == _TOO_LARGE:
        raise MeshError(f"its {len(raw)} bytes {last}; the file is damaged or no mesh of a body")
    if done.returncode:
        raise MeshError(f"cannot be read as DRC ({last[:200]}); the file is damaged or cut short")
    npy_stream = BytesIO(done.stdout)
    return np.load(npy_stream, allow_pickle=False), np.load(npy_stream, allow_pickle=False)
