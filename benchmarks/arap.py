"""Step II of the 2014 paper against the truth: the geodesic mapping alone, ARAP, and the time that one factorisation saves.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/arap.py --data FOLDER [--only NAME ...] [--every N] [--length L ...] [--order composed direct]

FOLDER holds NAME.npz (vertices, faces, vertex_offsets, face_offsets), NAME-body.npz and NAME.truth.json. Intervals and
leaves are those of Step I's defaults. Errors are in % of the body's height over all vertices of each interval's reference;
frames in which a leaf is lost count too. Turning is the median, over the interval's joints that turn by 15° at least, of
the share of the true turning that the alignment has. Seconds are of processor time on one core, after a first frame that
compiles: geodesic coordinates, mapping, ARAP with one factorisation for the interval, and with one in each frame. At a cut,
every vertex of a reference is mapped to the reference of the previous interval; its error is the distance to its true place
there, with the last of the lengths.
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
    extrema: dict[int, Extrema]
    coordinates: dict[int, GeodesicCoordinates]
    intervals: Intervals
    leaves: Leaves

    @classmethod
    def of(cls, path: Path, output: str, spent: Seconds) -> "Sequence":
        pipeline = Pipeline.of({"source": {"input": str(path)}, "output": output, "compute": {"executor": "sync"}})
        pipeline.run(until=("leaves",))

        def every(node: str, numbers: Iterable[int]) -> dict[int, Any]:
            return {t: pipeline.artifact(node, frame=t) for t in numbers}

        intervals: Any = pipeline.artifact("intervals")
        leaves: Any = pipeline.artifact("leaves")
        frames = intervals.frames
        mesh, extrema = every("mesh", frames), every("extrema", frames)
        geodesic_coordinates(mesh[frames[0]], extrema[frames[0]])
        begun = time.process_time()
        X = {t: geodesic_coordinates(mesh[t], extrema[t]) for t in mesh}
        spent.coordinates = (time.process_time() - begun) / len(mesh)
        return cls(mesh, every("geodesics", frames), extrema, X, intervals, leaves)

    def references(self) -> list[IntervalReference]:
        """The reference of every interval."""
        out = []
        for i, (begin, end) in enumerate(zip(self.intervals.begin, self.intervals.end, strict=True)):
            frames = self.intervals.frames[int(begin) : int(end) + 1]
            gathered = ({t: values[t] for t in frames} for values in (self.mesh, self.geodesics, self.coordinates))
            out.append(interval_reference((i,), *gathered, self.leaves, CHANGING))
        return out


def mapped(here: Sequence, i: int, reference: IntervalReference, order: str, spent: Seconds) -> dict[int, GeodesicMapping]:
    """The geodesic mapping of interval i, outwards from its middle."""
    params, mappings = GeodesicMappingParams.model_validate({"order": order}), dict[int, GeodesicMapping]()
    begun = time.process_time()
    middle = reference.frames.index(reference.frame)
    for t in sorted(reference.frames, key=lambda t: abs(reference.frames.index(t) - middle)):
        neighbour = reference.previous(t)
        previous = None if neighbour is None else mappings[neighbour]
        mappings[t] = geodesic_mapping((i, t), reference, here.coordinates[t], previous, params)
    spent.mapping += time.process_time() - begun
    return dict(sorted(mappings.items()))


def deformed(
    here: Sequence, reference: IntervalReference, images: dict[int, GeodesicMapping], length: float, steps: int, spent: Seconds
) -> Floats:
    """(frame, vertex, xyz) ARAP in the given frames with one factorisation."""
    V, F = np.array(reference.vertices), reference.faces.astype(np.int64)
    soft, out = soft_weights(np.array(reference.area), length * reference.size), []
    Factorised.of(V, F, soft).solve(V, steps=2)
    begun = time.process_time()
    system = Factorised.of(V, F, soft)
    spent.factor += time.process_time() - begun
    begun = time.process_time()
    for t, mapping in images.items():
        out.append(system.solve(targets(here, mapping, t), steps=steps).x)
    spent.arap += time.process_time() - begun
    spent.references += 1
    spent.frames += len(images)
    return np.stack(out)


def targets(here: Sequence, mapping: GeodesicMapping, t: int) -> Floats:
    """(vertex, xyz) the images of the reference's vertices in a frame."""
    return np.asarray(here.mesh[t].vertices[mapping.image])


def print_row(label: str, error: Floats, turning: float | None = None) -> None:
    share = "" if turning is None else f" {turning:8.2f}"
    print(f"    {label:34s} {error.mean():6.2f} {np.quantile(error, 0.95):6.2f} {error.max():6.1f}{share}", flush=True)


def scored(folder: Path, name: str, args: argparse.Namespace) -> None:
    """Errors of every interval, at every cut, and seconds."""
    spent = Seconds()
    with tempfile.TemporaryDirectory() as output:
        compared(folder, name, args, Sequence.of(folder / f"{name}.npz", output, spent), spent)


def compared(folder: Path, name: str, args: argparse.Namespace, here: Sequence, spent: Seconds) -> None:
    """One table for each order of the mapping."""
    references = here.references()
    truths = [Truth.of(folder, name, np.array(r.vertices), r.frame) for r in references]
    total = 0
    for order in args.order:
        alignments: list[Arap] = []
        for i, (start, truth) in enumerate(zip(references, truths, strict=True)):
            images = mapped(here, i, start, order, spent)
            total += len(images)
            picked = sorted({start.frame, start.frames[0], start.frames[-1], *start.frames[:: args.every]})
            images = {t: images[t] for t in picked}
            true = Truth(truth.x[picked], truth.part, truth.label, truth.joints, truth.height)
            raw = np.stack([targets(here, mapping, t) for t, mapping in images.items()])
            print(f"{name} {start.frames[0]}–{start.frames[-1]}, reference {start.frame}, {len(start.leaf)} leaves, {order}")
            print_row("geodesic mapping alone", np.linalg.norm(raw - true.x, axis=2) / truth.height * 100)
            for length in args.length:
                x = deformed(here, start, images, length, args.steps, spent)
                turns = [turn for turn in true.turns(x, picked.index(start.frame)) if turn.degrees >= TURNS]
                share = float(np.median([turn.share for turn in turns])) if turns else float("nan")
                print_row(f"ARAP, length {length} √A", np.linalg.norm(x - true.x, axis=2) / truth.height * 100, share)
            at = {t: _alignment(one) for t, one in zip(picked, x, strict=True)}
            # correspondences are found in the first and last frames only
            alignments += [at.get(t, at[start.frame]) for t in start.frames]
        _cuts(here, references, truths, alignments)
    arap, factor = spent.arap / spent.frames, spent.factor / spent.references
    print(
        f"    seconds a frame: coordinates {spent.coordinates:.2f}, mapping {spent.mapping / total:.3f}, ARAP {arap:.2f};"
        f" factorised anew in every frame {arap + factor:.2f}, {1 + factor / arap:.2f} times"
    )


def _alignment(x: Floats) -> Arap:
    plain = np.ones(len(x))
    return Arap(vertices=x, residual=0 * plain, stretch=plain, confidence=plain, uncovered=0.0, rigid_residual=9.0)


def _cuts(here: Sequence, references: list[IntervalReference], truths: list[Truth], alignments: list[Arap]) -> None:
    """How far the vertices of the previous interval that correspond across a cut are from their true places."""
    cuts = cut_correspondence(tuple(references), tuple(alignments), here.extrema)
    for i, (a, b) in enumerate(pairwise(references)):
        image = cuts.to_previous[cuts.rows(i + 1)]
        mapped = image >= 0
        error = np.linalg.norm(a.vertices[image[mapped]] - truths[i + 1].x[a.frame][mapped], axis=1) / truths[i].height * 100
        print_row(f"cut {a.frames[-1]}|{b.frames[0]}, {mapped.mean():.0%} of the vertices", error)


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
