"""Where compiled code is kept: the user's own cache."""

import os
from pathlib import Path


def kernel_folder() -> Path:
    """`NUMBA_CACHE_DIR`, or else `kinetree` in the user's cache; it need not be there yet."""
    root = os.environ.get("NUMBA_CACHE_DIR") or os.path.join(  # noqa: PTH118 - a path given by the environment stays as it is
        os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "kinetree"
    )
    return Path(root)
