"""How far joints depend on chance: the same alignments, each shaken a little several times, and what is found in each.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/stability.py --data FOLDER [--only NAME ...] [--every N] [--shakes 5] [--share 0.0005] [--work FOLDER]
                                   [--set TASK.NAME=VALUE ...]

Aligned vertices of every frame are moved by a few smooth waves over the body, drawn anew for every frame and shake; --share is
their amplitude, share of the height of the reference, a fifth of the error that alignments have. No wave goes on from frame to
frame, so none is a joint. A difference between two versions of the code that is no larger than the spread here says nothing.
FOLDER holds sequences as `accuracy.py` takes them; --every N takes each Nth frame alone. --work keeps the stores, so that
alignments are computed once.

Columns: joints found of those scored, mean error of those found in % of the height, spurious joints, as they are and for every
shake; then mean ± standard deviation of a sample (by n − 1), and in how many shakes each joint was lost that was lost in any.
"""

import argparse
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from accuracy import Case, recorded
from shaken_alignment import alignment

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.tasks import METHODS
from kinetree.tasks.registration.alignment import alignment as aligned


class Shaken(NamedTuple):
    """What one shake leaves: matched and scored joints, mean error in % of the height, spurious ones, names of those lost."""

    matched: int
    scored: int
    percent: float
    spurious: int
    lost: tuple[str, ...]

    @classmethod
    def of(cls, result: Evaluation) -> "Shaken":
        """Of an evaluation."""
        lost = tuple(joint.name for joint in result.joints if joint.scored and joint.found is None)
        s = result.summary
        if s is None:
            raise SystemExit("no truth is known of it")
        return cls(s.found, s.scored, float(s.percent if s.percent is not None else np.nan), s.spurious, lost)


def shaken(case: Case, every: int, shake: int, share: float, work: Path, sets: Sequence[str]) -> Shaken:
    """A run of a sequence with one shake."""
    graph = Graph.of(tuple(alignment if one is aligned else one for one in METHODS["mesoscopic"].tasks))
    blocks = dict(case.blocks)
    blocks["source"] = {**blocks["source"], "frames": f"::{every}"}
    blocks |= {"output": str(work / f"{case.name}-{every}"), "store": str(work / "store")}
    blocks["alignment"] = {"shake": shake, "share": share}
    pipeline = Pipeline.of(blocks, sets=sets, methods={"mesoscopic": graph})
    run = pipeline.run(until=["evaluation"])
    if run["status"] != "done":
        raise SystemExit(f"{case.name}, shake {shake}: {run['failures']}")
    result: Any = pipeline.artifact("evaluation")
    return Shaken.of(result)


def lines(name: str, rows: Sequence[Shaken]) -> Iterator[str]:
    """Rows of one sequence, the first as it is, and what they have in common."""
    for k, row in enumerate(rows):
        yield f"{name:<12}{k or 'as it is':>9}  {row.matched:>2} of {row.scored}  {row.percent:5.2f} %  {row.spurious:>2}"
    figures = np.array([row[:4] for row in rows[1:]], float)
    if len(figures):
        mean, deviation = figures.mean(axis=0), sample_deviation(figures)
        matched, _, percent, spurious = (f"{m:.2f} ± {d:.2f}" for m, d in zip(mean, deviation, strict=True))
        yield f"{name:<12}{'mean':>9}  {matched} of {rows[0].scored}, {percent} %, spurious {spurious}"
        lost = Counter(joint for row in rows[1:] for joint in row.lost)
        yield f"{name:<12}{'lost':>9}  " + ", ".join(
            f"{joint} {count} of {len(figures)}" for joint, count in lost.most_common()
        )


def sample_deviation(figures: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """(column,) that of what the rows were drawn from, by n − 1; NaN of one row."""
    return np.asarray(figures.std(axis=0, ddof=1)) if len(figures) > 1 else np.full(figures.shape[1], np.nan)


def main() -> None:
    """Reads the command line and prints the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--shakes", type=int, default=5)
    parser.add_argument("--share", type=float, default=0.0005)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--set", dest="sets", action="append", default=[])
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = (args.work or Path(scratch)).absolute()
        for case in recorded(args.data):
            if not args.only or case.name in args.only:
                rows = [shaken(case, args.every, k, args.share, work, args.sets) for k in range(args.shakes + 1)]
                print(*lines(case.name, rows), sep="\n", flush=True)


if __name__ == "__main__":
    main()
