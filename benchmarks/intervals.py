"""Cuts and leaves against the truth: precision and recall per cue, leaf counts, swaps of limbs.

    python benchmarks/intervals.py [--data FOLDER] [--only NAME ...] [--vertices N] [--bases N]

Sequences are generated, with contacts whose frames are known and without any. FOLDER may hold sequences as
NAME.npz beside NAME.truth.json and NAME-body.npz (the true body's vertices and weights), which are scored too: there a
contact is any arm of the true body nearer than 1 % of the height to the trunk or a leg. A cut counts if a true change
lies within two frames, each change counted once. A leaf counts as a tip if it lies within 10 % of the height of one;
frames without contact should have exactly the body's tips. Every line of the last table is one way of cutting.
"""

import argparse
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from contacts import CASES, TOLERANCE, Truth, generated, recorded
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.input.mesh import clean
from kinetree.tasks.numerics.topology.correlation import Normalisation, correlations, histograms
from kinetree.tasks.numerics.topology.extrema import extrema, stems
from kinetree.tasks.numerics.topology.geodesics import farthest_bases, mu
from kinetree.tasks.numerics.topology.intervals import Cue, Intervals, fixed_intervals, intervals, stacked
from kinetree.tasks.numerics.topology.leaves import follow
from kinetree.tasks.numerics.topology.mu_histogram import Summary, dimensionless, summary
from kinetree.tasks.numerics.topology.persistence import loop_counts, loop_spans, superlevel_peaks

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
STEP = 0.12


@dataclass
class Frame:
    """What one frame leaves behind."""

    x: Summary
    unweighted: Summary
    peaks: Floats
    loops: Floats
    euler: int
    components: int
    stems: Floats
    value: Floats
    size: float
    centre: Floats


def measured(V: Floats, F: Ints, bases: int) -> Frame:
    cleaned = clean(np.asarray(V, dtype=np.float64), np.asarray(F, dtype=np.int32))
    largest, faces, _ = largest_component(cleaned.V, cleaned.F)
    X = cleaned.V[largest]
    surface = Surface.of(X, faces)
    basis = farthest_bases(surface, bases)
    integral = mu(basis.distance, basis.weight)
    span = float(np.ptp(integral))
    tips = extrema(integral, faces)
    x = dimensionless(integral, surface.area)
    return Frame(
        x=summary(x, surface.area),
        unweighted=summary(integral),
        peaks=superlevel_peaks(integral, faces, 0.02 * span).persistence / span,
        loops=loop_spans(loop_counts(integral, faces)),
        euler=cleaned.euler,
        components=int(cleaned.is_body.sum()),
        stems=stems(X, faces, integral, surface.area, tips),
        value=x[tips.vertex],
        size=float(np.sqrt(surface.area.sum())),
        centre=surface.area @ X / surface.area.sum(),
    )


def ways(frames: Sequence[Frame]) -> dict[str, Intervals]:
    """Every way of cutting, one column of the report each."""
    H, letter = (_histograms([getattr(f, k) for f in frames], n) for k, n in (("x", "sequence"), ("unweighted", "frame")))
    cues = {
        # the first peak's persistence is the whole range, always 1
        "leaves": Cue(stacked([f.peaks[1:] for f in frames]), STEP),
        "loops": Cue(stacked([f.loops for f in frames]), STEP),
        "lost leaves": Cue(stacked([*(followed(frames) >= 0).T.astype(np.float64)]), 1.0),
        "components": Cue(np.array([[float(f.components)] for f in frames]), 1.0),
        "euler": Cue(np.array([[float(f.euler)] for f in frames]), 1.0),
    }
    default = {k: cues[k] for k in ("leaves", "loops")}
    return {
        "paper, C < 0.95": fixed_intervals(correlations(letter), 0.95, minimum=3),
        "paper, C < 0.90": fixed_intervals(correlations(letter), 0.90, minimum=3),
        "correlation": intervals(H, {}),
        **{k: intervals(H, {k: cue}, correlation=False) for k, cue in cues.items()},
        "leaves + loops": intervals(H, default, correlation=False),
        "default: correlation + leaves + loops": intervals(H, default),
        "everything": intervals(H, cues),
    }


def _histograms(rows: Sequence[Summary], normalisation: Normalisation) -> Floats:
    low, high, mass = (np.array(column) for column in zip(*rows, strict=True))
    return histograms(low, high, mass, normalisation)


def hits(cuts: Sequence[int], changes: Sequence[int]) -> int:
    """How many cuts have a true change of their own within the tolerance."""
    if not len(cuts) or not changes:
        return 0
    away = np.abs(np.subtract.outer(np.array(cuts), np.array(changes)))
    rows, columns = linear_sum_assignment(np.where(away <= TOLERANCE, away, 1000))
    return int((away[rows, columns] <= TOLERANCE).sum())


def followed(frames: Sequence[Frame]) -> Ints:
    size, centre = np.array([f.size for f in frames]), np.array([f.centre for f in frames])
    return follow([f.stems for f in frames], [f.value for f in frames], size, centre)


def leaf_scores(frames: Sequence[Frame], truth: Truth) -> str:
    """Frames with exactly the body's tips, swaps along tracks, tracks per tip, margins of persistence."""
    leaves = [f.peaks[f.peaks >= 0.20] for f in frames]
    below = [f.peaks[f.peaks < 0.20].max(initial=0.0) for f in frames]
    margin = f"persistence: least leaf {min(k.min() for k in leaves):.2f}, largest other {max(below):.3f}"
    tracks = followed(frames)
    if truth.tips is None:
        return f"leaves {min(map(len, leaves))}–{max(map(len, leaves))}, tracks {len(tracks)}, {margin}"
    tips = [_nearest(f, truth.tips[t], truth.height) for t, f in enumerate(frames)]
    free = np.flatnonzero(~truth.touching).tolist()
    exact = sum(sorted(tips[t]) == list(range(truth.tips.shape[1])) for t in free)
    swaps = []
    for counted in (free, range(len(frames))):
        limbs = [[tips[t][row[t]] for t in counted if row[t] >= 0 and tips[t][row[t]] >= 0] for row in tracks]
        swaps.append(sum(p != q for row in limbs for p, q in itertools.pairwise(row)))
    return (
        f"exact {exact}/{len(free)} free frames, swaps {swaps[0]} between free frames, {swaps[1]} with contact, "
        f"tracks {len(tracks)} for {truth.tips.shape[1]} tips, {margin}"
    )


def _nearest(frame: Frame, tips: Floats, height: float) -> list[int]:
    """For each leaf the true tip within reach, −1 if there is none."""
    away = np.linalg.norm(frame.stems[:, -1][:, None] - tips[None], axis=2)
    return [int(np.argmin(row)) if row.min() < 0.10 * height else -1 for row in away]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--vertices", type=int, default=4000)
    parser.add_argument("--bases", type=int, default=100)
    asked = parser.parse_args()
    sources: dict[str, Callable[[], tuple[Iterator[tuple[Floats, Ints]], Truth]]] = {
        name: lambda name=name: generated(name, asked.vertices) for name in CASES
    }
    if asked.data:
        stems_ = sorted(p.name.removesuffix(".npz") for p in asked.data.glob("*.npz"))
        known = [n for n in stems_ if not n.endswith(("-body", "rig"))]
        sources |= {f"{n} (data)": lambda n=n: recorded(asked.data, n) for n in known}
    totals: dict[tuple[bool, str], list[int]] = {}
    for name, source in sources.items():
        if asked.only and name not in asked.only:
            continue
        meshes, truth = source()
        frames = [measured(V, F, asked.bases) for V, F in meshes]
        cuts = ways(frames)
        chosen = cuts["default: correlation + leaves + loops"]
        listed = ", ".join(f"{e}|{e + 1} {'+'.join(c)}" for e, c in zip(chosen.end[:-1], chosen.cues, strict=True))
        true = ", ".join(f"{t}|{t + 1}" for t in truth.changes)
        print(f"{name}: true {true or 'none'}; cut {listed or 'nowhere'}\n    {leaf_scores(frames, truth)}", flush=True)
        if truth.tips is None:
            continue
        for way, divided in cuts.items():
            cut_at = divided.end[:-1].tolist()
            row = totals.get((name in CASES, way), [0, 0, 0])
            counts = hits(cut_at, truth.changes), len(cut_at), len(truth.changes)
            totals[name in CASES, way] = [a + b for a, b in zip(row, counts, strict=True)]
    print(f"\n{'way of cutting':50s} precision  recall   (within ±{TOLERANCE} frames)")
    for (ours, way), (hit, cut, real) in totals.items():
        line = f"{'generated' if ours else 'data'}: {way}"
        print(f"{line:50s} {hit / max(cut, 1):9.2f} {hit / max(real, 1):7.2f}   {hit} of {cut} cuts, {real} true changes")


if __name__ == "__main__":
    main()
