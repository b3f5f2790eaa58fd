"""Step II as the 2014 paper has it, against the truth: the mapping alone, ARAP upon it, what one factorisation saves.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/arap.py --data FOLDER [--only NAME ...] [--every N] [--length L ...] [--order composed direct]

FOLDER holds NAME.npz (vertices, faces, vertex_offsets, face_offsets), NAME-body.npz and NAME.truth.json. Intervals and
leaves are those of Step I's defaults. Errors in % of the body's height over all vertices of each interval's reference;
frames in which a leaf is lost count too. Turning is the median over the interval's joints that turn by 15° at least of
the share of the true turning that is left. Seconds are the processor's, on one core, after a first frame that compiles:
geodesic coordinates, mapping, ARAP with the interval's one factorisation, and with one more in each frame. At a
cut, every vertex of a reference is led to the reference of the interval before; its error is how far from there it is,
with the last of the lengths.
"""

import argparse
import tempfile
import time
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from turning import Truth

from kinetree.pipeline import Pipeline
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.geodesic_coordinates import GeodesicCoordinates
from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping, GeodesicMappingParams
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.paper_2014.arap import Factorised, soft_weights
from kinetree.tasks.paper_2014.cut_correspondence import cut_correspondence
from kinetree.tasks.paper_2014.geodesic_coordinates import geodesic_coordinates
from kinetree.tasks.paper_2014.geodesic_mapping import geodesic_mapping
from kinetree.tasks.paper_2014.interval_reference import interval_reference

Floats = npt.NDArray[np.float64]
CHANGING = Connectivity(fixed=False, first_change=1, vertices=0, faces=0)
TURNS = 15.0


@dataclass
class Seconds:
    """Processor time by step; of coordinates a frame."""

    coordinates: float = 0.0
    mapping: float = 0.0
    arap: float = 0.0
    factor: float = 0.0
    frames: int = 0
    references: int = 0


@dataclass(frozen=True)
class Sequence:
    """Step I of a sequence."""

    mesh: dict[int, Mesh]
    geodesics: dict[int, Geodesics]
    tips: dict[int, Extrema]
    coordinates: dict[int, GeodesicCoordinates]
    intervals: Intervals
    leaves: Leaves

    @classmethod
    def of(cls, path: Path, output: str, spent: Seconds) -> "Sequence":
        pipeline = Pipeline.of({"source": {"input": str(path)}, "output": output, "compute": {"executor": "sync"}})
        pipeline.run(until=("leaves",))

        def every(node: str, numbers: Iterable[int]) -> dict[int, Any]:
            return {t: pipeline.artifact(node, frame=t) for t in numbers}

        cuts: Any = pipeline.artifact("intervals")
        found: Any = pipeline.artifact("leaves")
        mesh, tip = every("mesh", cuts.frames), every("extrema", cuts.frames)
        geodesic_coordinates(mesh[cuts.frames[0]], tip[cuts.frames[0]])
        begun = time.process_time()
        X = {t: geodesic_coordinates(mesh[t], tip[t]) for t in mesh}
        spent.coordinates = (time.process_time() - begun) / len(mesh)
        return cls(mesh, every("geodesics", cuts.frames), tip, X, cuts, found)

    def middles(self) -> list[IntervalReference]:
        """The reference of every interval."""
        out = []
        for begin, end in zip(self.intervals.begin, self.intervals.end, strict=True):
            mine = self.intervals.frames[int(begin) : int(end) + 1]
            gathered = ({t: values[t] for t in mine} for values in (self.mesh, self.geodesics, self.coordinates))
            out.append(interval_reference(*gathered, self.intervals, self.leaves))
        return out


def mapped(here: Sequence, start: IntervalReference, order: str, spent: Seconds) -> dict[int, GeodesicMapping]:
    """The geodesic mapping of an interval, outwards from its middle."""
    params, found = GeodesicMappingParams.model_validate({"order": order}), dict[int, GeodesicMapping]()
    begun = time.process_time()
    for t in sorted(start.frames, key=lambda t: abs(start.frames.index(t) - start.frames.index(start.frame))):
        before = start.previous(t)
        last = None if before is None else found[before]
        found[t] = geodesic_mapping(start, here.coordinates[t], here.tips[t], CHANGING, last, params)
    spent.mapping += time.process_time() - begun
    return dict(sorted(found.items()))


def deformed(
    here: Sequence, start: IntervalReference, images: dict[int, GeodesicMapping], length: float, steps: int, spent: Seconds
) -> Floats:
    """(frame, vertex, xyz) ARAP in the given frames with one factorisation."""
    V, F = np.array(start.vertices), start.faces.astype(np.int64)
    soft, out = soft_weights(np.array(start.area), length * start.size), []
    Factorised.of(V, F, soft).solve(V, steps=2)
    begun = time.process_time()
    system = Factorised.of(V, F, soft)
    spent.factor += time.process_time() - begun
    begun = time.process_time()
    for t, match in images.items():
        out.append(system.solve(wanted(here, match, t), steps=steps).x)
    spent.arap += time.process_time() - begun
    spent.references += 1
    spent.frames += len(images)
    return np.stack(out)


def wanted(here: Sequence, match: GeodesicMapping, t: int) -> Floats:
    """(vertex, xyz) where the mapping wants every vertex of the reference."""
    return np.asarray(here.mesh[t].vertices[match.image])


def told(label: str, error: Floats, turning: float | None = None) -> None:
    share = "" if turning is None else f" {turning:8.2f}"
    print(f"    {label:34s} {error.mean():6.2f} {np.quantile(error, 0.95):6.2f} {error.max():6.1f}{share}", flush=True)


def scored(folder: Path, name: str, args: argparse.Namespace) -> None:
    """Errors of every interval, at every cut, and seconds."""
    spent = Seconds()
    with tempfile.TemporaryDirectory() as output:
        compared(folder, name, args, Sequence.of(folder / f"{name}.npz", output, spent), spent)


def compared(folder: Path, name: str, args: argparse.Namespace, here: Sequence, spent: Seconds) -> None:
    """One table for each order of the mapping."""
    starts = here.middles()
    truths = [Truth.of(folder, name, np.array(start.vertices), start.frame) for start in starts]
    total = 0
    for order in args.order:
        alignments: list[Arap] = []
        for start, truth in zip(starts, truths, strict=True):
            images = mapped(here, start, order, spent)
            total += len(images)
            picked = sorted({start.frame, start.frames[0], start.frames[-1], *start.frames[:: args.every]})
            images = {t: images[t] for t in picked}
            true = Truth(truth.x[picked], truth.part, truth.label, truth.joints, truth.height)
            raw = np.stack([wanted(here, match, t) for t, match in images.items()])
            print(f"{name} {start.frames[0]}–{start.frames[-1]}, reference {start.frame}, {len(start.leaf)} leaves, {order}")
            told("geodesic mapping alone", np.linalg.norm(raw - true.x, axis=2) / truth.height * 100)
            for length in args.length:
                x = deformed(here, start, images, length, args.steps, spent)
                turns = [turn for turn in true.turns(x, picked.index(start.frame)) if turn.degrees >= TURNS]
                share = float(np.median([turn.share for turn in turns])) if turns else float("nan")
                told(f"ARAP, length {length} √A", np.linalg.norm(x - true.x, axis=2) / truth.height * 100, share)
            at = {t: _alignment(one) for t, one in zip(picked, x, strict=True)}
            # the crossing looks at first and last frames alone
            alignments += [at.get(t, at[start.frame]) for t in start.frames]
        _cuts(here, starts, truths, alignments)
    arap, factor = spent.arap / spent.frames, spent.factor / spent.references
    print(
        f"    seconds a frame: coordinates {spent.coordinates:.2f}, mapping {spent.mapping / total:.3f}, ARAP {arap:.2f};"
        f" factorised anew in every frame {arap + factor:.2f}, {1 + factor / arap:.2f} times"
    )


def _alignment(x: Floats) -> Arap:
    plain = np.ones(len(x))
    return Arap(vertices=x, residual=0 * plain, stretch=plain, trust=plain, uncovered=0.0, moved=9.0)


def _cuts(here: Sequence, starts: list[IntervalReference], truths: list[Truth], alignments: list[Arap]) -> None:
    """How far the vertices to which the crossing leads are from where they should be."""
    across = cut_correspondence(tuple(starts), tuple(alignments), here.tips, here.leaves)
    for i, (a, b) in enumerate(pairwise(starts)):
        image = across.backward[across.rows(i + 1)]
        led = image >= 0
        error = np.linalg.norm(a.vertices[image[led]] - truths[i + 1].x[a.frame][led], axis=1) / truths[i].height * 100
        told(f"cut {a.frames[-1]}|{b.frames[0]}, {led.mean():.0%} of the vertices", error)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", nargs="*", default=["wave", "wolf"])
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--length", type=float, nargs="*", default=[0.04, 0.64, 0.16])
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--order", nargs="*", default=["composed"], choices=["composed", "direct"])
    args = parser.parse_args()
    print("                                        mean%   p95%   max%  turning")
    for name in args.only:
        scored(args.data, name, args)


if __name__ == "__main__":
    main()
