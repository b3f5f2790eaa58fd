"""Pictures of a run's results, by their names on the command line."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from kinetree.errors import ConfigError
from kinetree.tasks.results.plots.alignment import alignment
from kinetree.tasks.results.plots.derivation import cones, elimination, lengths, merging, structure
from kinetree.tasks.results.plots.drawing import FORMATS, Fetch, write_figure
from kinetree.tasks.results.plots.evaluation import evaluation
from kinetree.tasks.results.plots.macroscopic import correlation, mu
from kinetree.tasks.results.plots.mesoscopic import cones as cones_2014
from kinetree.tasks.results.plots.mesoscopic import lengths as lengths_2014
from kinetree.tasks.results.plots.mesoscopic import merging as merging_2014
from kinetree.tasks.results.plots.mesoscopic import structure as structure_2014
from kinetree.tasks.results.plots.motion import angles
from kinetree.tasks.results.plots.reeb import clusters, coherence, description, endoskeleton
from kinetree.tasks.results.plots.structure import confidence, skeleton, tree
from kinetree.tasks.results.plots.style import Style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Plots = Mapping[str, Callable[[Fetch, list[int], int], "Figure"]]

_BODY: Plots = {
    "correlation": correlation,
    "mu": mu,
    "alignment": alignment,
    "skeleton": skeleton,
    "tree": tree,
    "confidence": confidence,
}
_PARTS: Plots = {"cones": cones, "merging": merging, "structure": structure, "lengths": lengths}
_MOTION: Plots = {
    "angles": angles,
    "errors": evaluation,
}
PLOTS: Plots = {**_BODY, **_PARTS, **_MOTION, "elimination": elimination}
"""The pictures of the default method by name."""

_PARTS_2014: Plots = {"cones": cones_2014, "merging": merging_2014, "structure": structure_2014, "lengths": lengths_2014}
_GRAPHS_2009: Plots = {
    "endoskeleton": endoskeleton,
    "coherence": coherence,
    "clusters": clusters,
    "description": description,
}
PLOTS_OF_METHOD: Mapping[str, Plots] = {
    "mesoscopic": PLOTS,
    "mesoscopic-2014": {**_BODY, **_PARTS_2014, **_MOTION},
    "mesoscopic-2014-aligned": {**_BODY, **_PARTS_2014, **_MOTION},
    "reeb": {**_BODY, **_MOTION, **_GRAPHS_2009},
    "reeb-2009": {**_BODY, **_MOTION, **_GRAPHS_2009},
}
"""The pictures of each method."""


def draw(
    name: str, fetch: Fetch, frames: list[int], path: Path, up: int = 1, plots: Plots = PLOTS, style: Style = "screen"
) -> None:
    """Draws one of `plots` into a file, complete or not at all.

    fetch  : gives the artifact of a task
    frames : source frame numbers to draw, where a picture shows single frames
    up     : axis that points up, see `view`
    style  : for screens, or for papers
    raises : ConfigError where none of them has that name, the file's ending is none of FORMATS or it cannot be written
    """
    if name not in plots:
        methods = [method for method, own in PLOTS_OF_METHOD.items() if name in own]
        plots_of_run = ", ".join(sorted(plots))
        if methods:
            of_method = f"plot {name!r} is of method {' or '.join(methods)}"
            raise ConfigError(f"{of_method}, and this run has another; its plots: {plots_of_run}")
        raise ConfigError(f"plot {name!r} is not known; known plots: {plots_of_run}")
    if path.suffix.lower() not in FORMATS:
        raise ConfigError(f"{path}: pictures end in {', '.join(FORMATS)}")
    write_figure(plots[name](fetch, frames, up), path, style)
