"""Both methods side by side in a few frames (2014, Figs. 19 and 20, where the paper is compared with other methods)."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.registration.projection import Projection
from kinetree.tasks.reproduction.sequence import PRESETS, Run, Sequence
from kinetree.tasks.reproduction.table import Table
from kinetree.tasks.results.formats.colours import pale_part_colours
from kinetree.tasks.results.formats.labels import input_labels
from kinetree.tasks.results.formats.rig import skinned
from kinetree.tasks.results.plots.drawing import blank, surface, view
from kinetree.tasks.results.plots.structure import bones, label_colours, part_colours

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Panel = Callable[["Axes", Run, int, Floats], None]
"""Draws one frame of one run into axes, in the directions of a view."""
FRAMES = 4
COLUMNS = ("method", "frames", "joints", "ends", "parts")


def figure_19(sequence: Sequence) -> "tuple[Figure, Table]":
    """Parts and skeleton over the aligned surface in a few frames, a row for each method."""
    return _drawn(sequence, "figure-19", "Figure 19: both methods, parts and skeletons", _skeleton)


def figure_20(sequence: Sequence) -> "tuple[Figure, Table]":
    """Parts on the captured meshes themselves, whose connectivity changes, a row for each method."""
    return _drawn(sequence, "figure-20", "Figure 20: both methods, parts on the captured meshes", _captured)


def _drawn(sequence: Sequence, name: str, title: str, panel: Panel) -> "tuple[Figure, Table]":
    runs = [sequence.run(preset, until=("evaluation", "up_direction")) for preset in PRESETS]
    frames = [frame for frame in runs[0].some(FRAMES) if all(frame in run.fetch("skeleton").frames for run in runs)]
    figure, grid = blank(3.0 * len(frames), 4.4 * len(runs), len(frames), len(runs))
    panels = np.reshape(grid, (len(runs), len(frames)))
    for run, row in zip(runs, panels, strict=True):
        body = run.fetch("skeleton")
        axis = view([skinned(body, body.frames.index(frame)) for frame in frames], run.fetch("up_direction").axis)
        for axes, frame in zip(row, frames, strict=True):
            panel(axes, run, frame, axis)
            axes.set_title(f"{run.preset}, frame {frame}", fontsize=9)
    rows = tuple((run.preset, *_counts(run)) for run in runs)
    return figure, Table(name, title, COLUMNS, rows, ("the paper shows other methods in the place of the default",))


def _skeleton(axes: "Axes", run: Run, frame: int, axis: Floats) -> None:
    body = run.fetch("skeleton")
    t = body.frames.index(frame)
    surface(axes, skinned(body, t) @ axis, body.faces, part_colours(body))
    bones(axes, body, body.positions[t] @ axis)


def _captured(axes: "Axes", run: Run, frame: int, axis: Floats) -> None:
    body, mesh = run.fetch("skeleton"), run.fetch("mesh", frame=frame)
    of_input = input_labels(body, run.there.artifact(Projection, frame=frame))
    label = np.full(len(mesh.vertices), -1, np.int32)
    known = mesh.vertex_of_input >= 0
    label[mesh.vertex_of_input[known]] = of_input[known]
    surface(axes, mesh.vertices @ axis, mesh.faces, label_colours(label, mesh.faces, pale_part_colours(body.label, body.faces)))


def _counts(run: Run) -> tuple[int, int, int, int]:
    body = run.fetch("skeleton")
    return len(body.frames), body.kinds.count("joint"), body.kinds.count("leaf"), len(np.unique(body.label[body.label >= 0]))
