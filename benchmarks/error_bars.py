"""Fits the constants of the expected error of joints to generated bodies, and says what they are worth on others.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/error_bars.py [--seeds 10] [--frames 14] [--vertices 2000] [--figures human quadruped random]
                                    [--fixed 4] [--long 3] [--spoilt FOLDER] [--data FOLDER] [--work FOLDER]

Bodies are those of `benchmarks/accuracy.py`, with --fixed of them of fixed connectivity and --long of them of more frames
and vertices, and those that an earlier call of `benchmarks/robustness.py --work FOLDER` left, with noise, holes, missing frames
and clothes. The constants are fitted to even seeds, of every run with one cut and with several, and printed as
`ErrorBarsSettings` has them. Where joints have surface offsets, exponents lie a fifth of the way to the law of those that have
none, each figure keeps the bound, and the longer bodies do too. The least error and the bound of the other laws are fitted to
bodies of fixed connectivity too; what takes the place of the least error there, to them alone.
Spoilt bodies count for several cuts alone. The tables judge the shipped constants, and the fitted ones, on odd seeds and on the
recorded sequences of FOLDER (NAME.npz beside NAME.truth.json), to which nothing is fitted.
A joint's error is the mean distance from its true joint; of a spurious joint, from the nearest. Columns: joints; share that
keeps the bound of 90 %, and of the errors in single frames; area under the curve of telling joints within 2.5 % of the height
by the expected error, and the range of nine tenths of it over bodies drawn anew; rank correlation with the error; and, by
fifths of the expected error, its median against the median error, % of the height.
"""

import argparse
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
from accuracy import Bodies, Case, generated, recorded
from joint_errors import Joints, joints_of, spoilt
from scipy.stats import rankdata, spearmanr

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.structure.error_bars import (
    LEAST,
    ErrorBarsSettings,
    PowerLaw,
    error_bars,
    fitted,
    levels,
)
from kinetree.tasks.numerics.structure.laid_parts import LaidPartsSettings

CLOSE = 0.025
"""Error of a joint that is placed well, share of the height."""
BOUND = 0.9
"""Share of the joints that keep the bound."""
ON_SURFACES = slice(6, 11)
"""Columns of the evidence that the law without surfaces does not go by, see `PowerLaw`."""
SHRUNK = 0.2
"""How far exponents on surfaces lie from the best fit towards the law without surfaces, share. With 0.2 and 0.25 the errors of
even bodies that are left out one after the other are foretold best."""
LONG_FRAMES, LONG_VERTICES = 36, 6000
"""Of the longer bodies."""
DRAWS = 400
"""Draws of bodies for the spread of an area under the curve."""
KEEP = 0.89
"""Share that keeps it at least among bodies surfaced anew, and among those of fixed connectivity or of more frames."""


def _is_by_law(run: Joints) -> Flags:
    """(joint,) whether the law gives the whole error of each joint."""
    known = run.features
    is_share = known.is_end_joint & (run.cuts > 1)
    return np.asarray(~is_share & np.isnan(known.tube) & np.isnan(known.narrowing) & np.isnan(known.mirrored))


def fitted_law(
    anew: Sequence[Joints], others: Sequence[Joints], uncertain: float, without_surfaces: PowerLaw | None = None
) -> PowerLaw:
    """The constants that fit the errors of these runs, all of one cut or all of several, for joints whose whole
    error the law gives (`_is_by_law`).

    The least error is the smallest with which the bound holds on both kinds of bodies.

    anew, others : bodies surfaced anew in every frame, to which exponents are fitted · others that keep the bound too: those
                   of fixed connectivity, or of more frames
    without_surfaces : the law of bodies whose joints have no surface offset; given, these have one: the law goes by all
                   evidence, each figure keeps its bound, and exponents lie between those that fit best and that law's
    """

    def table(runs: Sequence[Joints]) -> tuple[Floats, Floats]:
        moves = [_is_by_law(r) for r in runs]
        error = [r.mean / r.features.size / r.features.widening(uncertain).mean(axis=0) for r in runs]
        rows = np.concatenate([r.features.logarithms(r.cuts > 1)[k] for r, k in zip(runs, moves, strict=True)])
        if without_surfaces is None:
            rows[:, ON_SURFACES] = 0.0
        return rows, np.concatenate([e[k] for e, k in zip(error, moves, strict=True)])

    rows, error = table(anew)
    best = fitted(rows, error)
    if without_surfaces is not None:
        best = (1.0 - SHRUNK) * best + SHRUNK * without_surfaces.coefficients
        best[0] += np.mean(np.log(np.maximum(error, LEAST)) - rows @ best)
    law = PowerLaw(*best.tolist(), least=0.0, bound=1.0)
    kinds = [table(runs) for runs in (anew, others) if runs]
    figures = {r.body.partition("-")[0] for r in anew}
    each = [table([r for r in anew if r.body.partition("-")[0] == figure]) for figure in figures]
    whole = [(np.concatenate([k[0] for k in kinds]), np.concatenate([k[1] for k in kinds]))]
    for least in np.arange(0.0, 0.01, 0.00025).tolist():
        law = law._replace(least=least)
        bounds = [np.quantile(error / levels(rows, law), BOUND) for rows, error in (each if without_surfaces else whole)]
        law = law._replace(bound=float(max(bounds)))
        if all((error <= law.bound * levels(rows, law)).mean() >= KEEP for rows, error in kinds):
            break
    return law


def fitted_along_axis(fixed: Sequence[Joints], settings: ErrorBarsSettings) -> float:
    """Least error along the line that a joint turns about with which nine of ten keep the bound, each figure weighing alike.

    fixed   : bodies of fixed connectivity
    returns : radii of the border
    """

    def share(along: float) -> float:
        keeps: dict[str, list[Flags]] = {}
        for run in fixed:
            bound = error_bars(run.features, run.cuts, settings._replace(along_axis=along)).bound
            keeps.setdefault(run.body.partition("-")[0], []).append(run.mean <= bound)
        return float(np.mean([np.concatenate(of).mean() for of in keeps.values()]))

    tried = np.arange(0.0, 0.2, 0.005).tolist()
    return float(next((along for along in tried if share(along) >= BOUND), tried[-1]))


def fitted_widening(runs: Sequence[Joints]) -> float:
    """By what errors grow where confidence is 0: the value with which errors of a joint's frames vary least about it."""

    def misfit(k: float) -> float:
        logs = [np.log(np.maximum(r.error, 1e-6 * r.height) / r.features.widening(k)) for r in runs]
        return float(np.mean([np.square(x - x.mean(axis=0)).mean() for x in logs if x.size]))

    tried = np.arange(0.0, 8.01, 0.25)
    return float(tried[np.argmin([misfit(k) for k in tried])])


def worth(name: str, runs: Sequence[Joints], settings: ErrorBarsSettings) -> str:
    """A row of the table."""
    bars = [error_bars(r.features, r.cuts, settings) for r in runs]
    error = np.concatenate([100 * r.mean / r.height for r in runs])
    expected = np.concatenate([100 * b.expected / r.height for b, r in zip(bars, runs, strict=True)])
    keeps = np.concatenate([r.mean <= b.bound for b, r in zip(bars, runs, strict=True)])
    in_frame = [(r.error <= b.bound / b.expected * b.in_frame).ravel() for b, r in zip(bars, runs, strict=True)]
    order = np.array_split(np.argsort(expected), 5)
    fifths = ", ".join(f"{np.median(expected[k]):.2f}→{np.median(error[k]):.2f}" for k in order if len(k))
    close = error <= 100 * CLOSE
    area, drawn = area_under_curve(expected, close), _spread_over_bodies(runs, expected, close)
    return (
        f"| {name} | {len(error)} | {100 * keeps.mean():.0f} % | {100 * np.concatenate(in_frame).mean():.0f} % | {area:.2f}"
        f" ({drawn}) | {(~close).sum()} | {spearmanr(expected, error).statistic:.2f} | {fifths} |"
    )


def area_under_curve(expected: Floats, close: Floats) -> float:
    """How often a joint placed well has the smaller expected error of a pair with one that is not; NaN where all are alike."""
    well, badly = int(close.sum()), int((~close).sum())
    if not well or not badly:
        return float("nan")
    return float((rankdata(expected)[~close].sum() - badly * (badly + 1) / 2) / (well * badly))


def _spread_over_bodies(runs: Sequence[Joints], expected: Floats, close: Flags) -> str:
    """Range of nine tenths of the area under the curve where bodies are drawn anew with replacement."""
    body = np.repeat([r.body for r in runs], [len(r.mean) for r in runs])
    joints = [np.flatnonzero(body == name) for name in np.unique(body)]
    rng, drawn = np.random.default_rng(0), []
    for _ in range(DRAWS):
        at = np.concatenate([joints[k] for k in rng.integers(len(joints), size=len(joints))])
        drawn.append(area_under_curve(expected[at], close[at]))
    known = np.array(drawn)[np.isfinite(drawn)]
    return "–".join(f"{q:.2f}" for q in np.quantile(known, (0.05, 0.95))) if len(known) else "–"


def groups(cases: Iterator[Case], work: Path, sets: Sequence[str]) -> dict[str, list[Joints]]:
    """Runs that are fitted to, and those held out, by name of the group."""
    by_group: dict[str, list[Joints]] = {}
    for case in cases:
        run = joints_of(case, work, sets)
        if run is not None and len(run.mean):
            by_group.setdefault(group_of(case), []).append(run)
            print(case.name, len(run.mean), flush=True)
    return by_group


def group_of(case: Case) -> str:
    """Which row of the table a case counts in."""
    if case.group == case.name:
        return "recorded, fixed" if case.name.endswith("-body") else "recorded"
    seed = int(re.findall(r"-(\d+)(?:-|$)", case.name)[0])
    return f"{case.group}, {'odd' if seed % 2 else 'even'} seeds"


def named(groups: Mapping[str, Sequence[Joints]], seeds: str, fixed: bool) -> list[Joints]:
    """The runs of generated bodies of odd or even seeds, of fixed connectivity or surfaced anew, without the longer ones."""
    return [
        run
        for name, runs in groups.items()
        if seeds in name and fixed == ("fixed" in name) and not name.startswith("long")
        for run in runs
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--frames", type=int, default=14)
    parser.add_argument("--vertices", type=int, default=2000)
    parser.add_argument("--figures", nargs="*", default=["human", "quadruped", "random"])
    parser.add_argument("--fixed", type=int, default=4, help="how many seeds of fixed connectivity")
    parser.add_argument("--long", type=int, default=3, help="how many seeds of more frames")
    parser.add_argument("--spoilt", type=Path)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--work", type=Path)
    asked = parser.parse_args()
    if asked.seeds and asked.frames < (least := LaidPartsSettings().least_frames):
        parser.error(
            f"--frames {asked.frames}: constants are fitted to joints that have a surface offset, which need {least} frames;"
            f" give --frames {least} or more, or --seeds 0 to judge the shipped constants alone"
        )
    with tempfile.TemporaryDirectory() as folder:
        work = asked.work or Path(folder)

        def cases() -> Iterator[Case]:
            for kind, seeds in (("new", asked.seeds), ("fixed", asked.fixed)):
                bodies = Bodies(asked.figures, range(seeds), ("walk",), (), asked.frames, asked.vertices, kind)
                for case in generated(bodies, work / "figures"):
                    yield case if kind == "new" else replace(case, name=f"fixed-{case.name}", group=f"fixed {case.group}")
            yield from recorded(asked.data) if asked.data else ()

        def longer() -> Iterator[Case]:
            bodies = Bodies(asked.figures, range(asked.long), ("walk",), (), LONG_FRAMES, LONG_VERTICES, "new")
            for case in generated(bodies, work / "figures"):
                yield replace(case, name=f"long-{case.name}", group=f"long {case.group}")

        spoilt_ones = spoilt(asked.spoilt.absolute()) if asked.spoilt else ()
        several = groups(chain(cases(), longer(), spoilt_ones), work, ())
        one = groups(cases(), work, ("rigid_parts.cuts=1",))
    shipped = ErrorBarsSettings()
    judged_by = {"shipped": shipped}
    if asked.seeds:
        learned = [[named(of, "even", fixed) for fixed in (False, True)] for of in (several, one)]
        uncertain = fitted_widening(learned[0][0])
        laws = [fitted_law(*runs, uncertain) for runs in learned]
        has_offset = any(np.isfinite(run.features.offset).any() for run in learned[0][0])
        of_more = [run for name, runs in several.items() if name.startswith("long") and "even" in name for run in runs]
        on_surfaces = fitted_law(learned[0][0], of_more, uncertain, shipped.several_cuts) if has_offset else shipped.on_surfaces
        fitted_to = shipped._replace(several_cuts=laws[0], on_surfaces=on_surfaces, one_cut=laws[1], uncertain=uncertain)
        if learned[0][1]:
            fitted_to = fitted_to._replace(along_axis=fitted_along_axis(learned[0][1], fitted_to))
        judged_by["fitted"] = fitted_to
        print(judged_by["fitted"])
    head = "| bodies | joints | bound | bound, in a frame | AUC | not within 2.5 % | rank | expected → error, % of the height |"
    for title, settings in judged_by.items():
        for cuts, of in (("several cuts", several), ("one cut", one)):
            print(f"\n{title} constants, {cuts}\n\n{head}\n|---|---|---|---|---|---|---|---|")
            odd, fixed = named(of, "odd", False), named(of, "odd", True)
            for name, runs in [*of.items(), ("all odd seeds", odd), ("all odd seeds, fixed", fixed)]:
                if runs:
                    print(worth(name, runs, settings))


if __name__ == "__main__":
    main()
