"""Joints that are found, and their error, on surfaces with noise (2014, Fig. 21)."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from kinetree.errors import NodesFailedError
from kinetree.schemas.array import Floats, Ints
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.reproduction.joints import evaluation
from kinetree.tasks.reproduction.printed import HEIGHT
from kinetree.tasks.reproduction.sequence import PRESETS, Sequence
from kinetree.tasks.reproduction.table import Cell, Table
from kinetree.tasks.results.plots.drawing import COLOURS, blank

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIGMAS = (0.0, 1.0, 2.0)
"""Standard deviation of the noise along the normals, mm on a body of 1,500 mm; the paper has 1."""
COLUMNS = ("σ mm", "σ % of height", "method", "true joints", "found", "spurious", "error %")


def figure_21(sequence: Sequence) -> "tuple[Figure, Table]":
    """Found joints and their mean error over the noise, a line for each method; copies of a given sequence get it."""
    rows = [
        (sigma, 100 * sigma / HEIGHT, preset, *_measured(sequence, preset, sigma)) for preset in PRESETS for sigma in SIGMAS
    ]
    notes = ("noise along the normals; scored are true joints that turn; the paper draws σ = 1 and gives no figures",)
    return _drawn(rows), Table("figure-21", "Figure 21: joints found on noisy surfaces", COLUMNS, tuple(rows), notes)


def _measured(sequence: Sequence, preset: str, sigma: float) -> tuple[Cell, ...]:
    """True joints, found, spurious and the mean error in % of the height; none where the method fails on the noise."""
    beside = f"-noise-{sigma:g}"
    try:
        if not sigma:
            run = sequence.run(preset)
        elif sequence.input is None:
            run = sequence.run(preset, f"source.synth.noise={sigma / HEIGHT:.6f}", beside=beside)
        else:
            run = _noisy(sequence, sigma / HEIGHT).run(preset, beside=beside)
    except NodesFailedError as error:
        sequence.tell(str(error))
        return None, None, None, None
    summary = evaluation(run).summary
    return (summary.scored, summary.found, summary.spurious, summary.percent) if summary else (None, None, None, None)


def _noisy(sequence: Sequence, share: float) -> Sequence:
    """The given sequence with noise along the normals, a share of the height in standard deviation, written beside the runs.

    Frames keep their numbers, connectivity, rate and unit; what cleaning leaves out of a frame is not written.
    """
    clean = sequence.run(PRESETS[0])
    folder = sequence.output / f"noise-{share * HEIGHT:g}"
    folder.mkdir(parents=True, exist_ok=True)
    sigma, properties = share * evaluation(clean).height, clean.fetch("sequence")
    for frame in clean.frames:
        mesh = clean.fetch("mesh", frame=frame)
        path = folder / f"frame_{frame:06d}.ply"
        path.write_bytes(noisy_ply(np.array(mesh.vertices), mesh.faces.astype(np.int64), sigma, frame))
    known = {"fps": properties.fps, "unit": properties.unit}
    sets = [f"sequence.{name}={value}" for name, value in known.items() if value is not None]
    own = tuple(text for text in sequence.sets if not text.startswith("source."))
    return replace(sequence, input=folder, sets=(*own, *sets))


def noisy_ply(V: Floats, F: Ints, sigma: float, seed: int) -> bytes:
    """A mesh as PLY, every vertex moved along its normal by Gaussian noise.

    V, F  : (vertex, xyz) mesh unit · (face, corner)
    sigma : standard deviation, mesh unit
    """
    import trimesh

    step = np.random.default_rng(seed).normal(0.0, sigma, len(V))
    moved = trimesh.Trimesh(V + step[:, None] * vertex_normals(V, F), F, process=False)
    return bytes(moved.export(file_type="ply", vertex_normal=False))


def _drawn(rows: "list[tuple[Cell, ...]]") -> "Figure":
    figure, (left, right) = blank(8.4, 3.4, 2)
    for preset, colour in zip(PRESETS, COLOURS, strict=False):
        mine = [row for row in rows if row[2] == preset]
        for axes, column in ((left, 4), (right, 6)):
            values = [float("nan") if row[column] is None else row[column] for row in mine]
            axes.plot([row[0] for row in mine], values, marker="o", ms=4, color=colour, label=preset)
    scored = max((row[3] for row in rows if isinstance(row[3], int)), default=0)
    left.axhline(scored, color="0.6", lw=0.8, ls="--")
    left.set(xlabel="σ, mm on a body of 1,500 mm", ylabel=f"joints found, of {scored}", ylim=(0, None))
    right.set(xlabel="σ, mm on a body of 1,500 mm", ylabel="mean error of these, % of the height", ylim=(0, None))
    left.legend(fontsize=8)
    return figure
