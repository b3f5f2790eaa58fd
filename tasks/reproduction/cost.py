"""Seconds a frame by step of the method (2014, Table 1)."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.graph import AnyTask
from kinetree.schemas.input.mesh import Mesh
from kinetree.tasks.paper_2014 import STEP_2, STEP_2_ALIGNED
from kinetree.tasks.reproduction.printed import CITATION, TABLE_1
from kinetree.tasks.reproduction.sequence import PRESETS, Run, Sequence
from kinetree.tasks.reproduction.table import Table

STEPS = ("macroscopic", "microscopic", "mesoscopic")
"""Steps I, II and III (2014, Secs. 4, 5 and 6)."""
STEP_OF_SHELF: Mapping[str, str] = {
    "input": "not counted",
    "topology": "macroscopic",
    "registration": "microscopic",
    "structure": "mesoscopic",
    "paper_2014": "mesoscopic",
    "results": "not counted",
}
"""The step of the tasks of a shelf; reading meshes and writing results are none."""
MICROSCOPIC_2014 = frozenset(task.name for task in (*STEP_2, *STEP_2_ALIGNED))
"""Tasks of Step II on the shelf of the 2014 paper, whose other tasks are of Step III."""
COLUMNS = ("sequence", "method", "frames", "vertices", "edges", *(f"{step} s" for step in STEPS), "total s")


def step(task: AnyTask) -> str:
    """The step of the method that a task is part of, or "not counted"."""
    return "microscopic" if task.name in MICROSCOPIC_2014 else STEP_OF_SHELF[task.module.split(".")[2]]


def table_1(sequence: Sequence) -> Table:
    """Vertices, edges and seconds a frame by step for both methods, below the paper's; means over the frames."""
    printed = [(p.sequence, "printed", None, p.vertices, p.edges, *p[3:]) for p in TABLE_1]
    runs = [sequence.run(preset) for preset in PRESETS]
    return Table(
        "table-1",
        "Table 1: seconds a frame by step",
        COLUMNS,
        (*printed, *((sequence.name, run.preset, *measured(run)) for run in runs)),
        (
            f"printed: {CITATION}; C++, Core i7 of 2.3 GHz; vertices and edges of human and head are approximate",
            "ours: seconds of all nodes on record, as if one ran after the other, divided by the frames",
            "reading meshes and writing results are not counted",
            "free keeps its connectivity: the paper skips its first two steps, whose seconds it prints in brackets",
        ),
    )


def measured(run: Run) -> tuple[int | float, ...]:
    """Frames, vertices and edges of a run, and its seconds a frame by step and in all."""
    seconds = dict.fromkeys(STEPS, 0.0)
    for timing in run.there.timings.tasks:
        part = step(run.pipeline.tasks.task(timing.task))
        if part in seconds:
            seconds[part] += timing.seconds / len(run.frames)
    meshes = [run.fetch("mesh", frame=frame) for frame in run.frames]
    vertices, edges = (round(float(np.mean(count))) for count in zip(*map(_size, meshes), strict=True))
    return len(run.frames), vertices, edges, *seconds.values(), sum(seconds.values())


def _size(mesh: Mesh) -> tuple[int, int]:
    F = np.sort(np.asarray(mesh.faces, dtype=np.int64), axis=1)
    pairs = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [0, 2]]])
    return len(mesh.vertices), len(np.unique(pairs, axis=0))
