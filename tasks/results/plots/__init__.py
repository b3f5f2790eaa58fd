"""Pictures for people, by the word of the command line."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from kinetree.errors import ConfigError
from kinetree.tasks.results.plots.alignment import alignment
from kinetree.tasks.results.plots.derivation import cones, elimination, lengths, merging, structure
from kinetree.tasks.results.plots.drawing import FORMATS, Fetch, written
from kinetree.tasks.results.plots.evaluation import evaluation
from kinetree.tasks.results.plots.macroscopic import correlation, mu
from kinetree.tasks.results.plots.mesoscopic import cones as cones_2014
from kinetree.tasks.results.plots.mesoscopic import lengths as lengths_2014
from kinetree.tasks.results.plots.mesoscopic import merging as merging_2014
from kinetree.tasks.results.plots.mesoscopic import structure as structure_2014
from kinetree.tasks.results.plots.motion import angles
from kinetree.tasks.results.plots.structure import confidence, skeleton, tree

if TYPE_CHECKING:
    from matplotlib.figure import Figure

StructureFigures = Mapping[str, Callable[[Fetch, list[int], int], "Figure"]]

WHAT: StructureFigures = {
    "correlation": correlation,
    "mu": mu,
    "alignment": alignment,
    "skeleton": skeleton,
    "tree": tree,
    "confidence": confidence,
    "cones": cones,
    "merging": merging,
    "elimination": elimination,
    "structure": structure,
    "lengths": lengths,
    "angles": angles,
    "errors": evaluation,
}
"""What can be drawn of the default method, by the word of the command line."""

_LETTER: StructureFigures = {"cones": cones_2014, "merging": merging_2014, "structure": structure_2014, "lengths": lengths_2014}
_SHARED = {name: drawn for name, drawn in WHAT.items() if name != "elimination"}
OF: Mapping[str, StructureFigures] = {"mesoscopic": WHAT, "mesoscopic-2014": {**_SHARED, **_LETTER}}
"""What can be drawn of each method."""


def draw(what: str, fetch: Fetch, frames: list[int], path: Path, up: int = 1, figures: StructureFigures = WHAT) -> None:
    """Draws one of `figures` into a file, complete or not at all.

    up     : see `view`
    raises : ConfigError where `what` is not one of them, the file's ending is none of FORMATS or it cannot be written
    """
    if what not in figures:
        raise ConfigError(f"plot {what!r}; there are: {', '.join(sorted(figures))}")
    if path.suffix.lower() not in FORMATS:
        raise ConfigError(f"{path}: pictures end in {', '.join(FORMATS)}")
    written(figures[what](fetch, frames, up), path)
