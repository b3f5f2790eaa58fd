"""Where a data set must not write: into the inputs of its sequences, and where it looks for sequences."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kinetree.errors import ConfigError
from kinetree.pipeline.dataset.sequences import NAME, WILD, matches
from kinetree.pipeline.settings.config import Config

OUTPUT = f"results/{NAME}"
"""Where results lie if nothing else is said."""


def refuse_overlap(configs: Mapping[str, Config], inputs: Mapping[str, str], sequences: Any, base: Path, where: str) -> None:
    """Results must not lie where a later run would look for sequences."""
    patterns = [sequences] if isinstance(sequences, str) else sequences if isinstance(sequences, list) else []
    wild = [os.path.normpath(base / Path(p).expanduser()) for p in patterns if WILD.search(p) and "://" not in p]
    for config in configs.values():
        places = {"output": config.output, **({"store": config.store} if isinstance(config.store, Path) else {})}
        for key, place in places.items():
            for pattern in wild:
                inner = next(
                    (p for p in (place, *place.parents) if str(p) not in inputs.values() and matches(p, pattern)), None
                )
                if inner is not None:
                    raise ConfigError(
                        f"{where}: {key} {place} lies in {inner}, which the pattern {pattern} would take for a sequence; name"
                        f" another folder, e.g. {OUTPUT}"
                    )
            for other, path in inputs.items():
                if "://" not in path and place.is_relative_to(path):
                    raise ConfigError(
                        f"{where}: {key} {place} lies in {path}, the input of {other}; name a folder outside it, e.g. {OUTPUT}"
                    )
