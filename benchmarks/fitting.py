"""Where the time of fitting a frame goes, and what its compiled loops gain over the same with whole arrays.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/fitting.py [vertices] [repeats]

A generated human is brought near the next frame, as the chain of tracking does it, and bent onto it from there and from
the frame before. Prints milliseconds of processor time, the least of
some repeats, and ratios within this run: rows of matches against numpy, sorting along the Morton curve against numpy's lexsort.
"""

import sys
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

from kinetree.schemas.input.synth import SynthParams
from kinetree.schemas.registration.deformation_graph import DeformationGraphParams
from kinetree.schemas.registration.tracking import TrackingParams
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.geometry import morton_curve
from kinetree.tasks.numerics.registration import deformation, tracking
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph
from kinetree.tasks.numerics.registration.first_fit import first_fit
from kinetree.tasks.numerics.registration.match_rows import match_rows
from kinetree.tasks.numerics.registration.near_pose import near_pose, thinned_body, thinned_frame
from kinetree.tasks.registration.deformation_graph import graph_settings
from kinetree.tasks.registration.pose import fit_settings

STAGES = {
    deformation: (
        "_matches",
        "match_rows",
        "add_data",
        "add_edges",
        "conjugate_gradients",
        "row_energies",
        "deformed",
        "turned",
    ),
    tracking: ("uncovered", "fit"),
}
"""Where the functions are looked up whose time is taken."""


def main(vertices: int, repeats: int) -> None:
    """Prints the stages of a fit and the ratios."""
    generated = body(recipe(SynthParams(figure="human", frames=108, vertices=vertices)))
    frames = [generated.frame(t) for t in (53, 54)]
    graph = deformation_graph(*frames[0], graph_settings(DeformationGraphParams()))
    frame = Target.of(*frames[1], graph.size)
    start, settings = deformation.at_rest(graph), fit_settings(TrackingParams())
    print(f"{len(graph.V):,} vertices, {len(graph.node)} nodes, {len(graph.pair):,} blocks")
    print(f"{'preparing the frame':<24}{least(lambda: Target.of(*frames[1], graph.size), repeats):8.1f} ms")
    cloud, points = thinned_body(graph), thinned_frame(*frames[1], graph.size)
    print(f"{'preparing few points':<24}{least(lambda: thinned_frame(*frames[1], graph.size), repeats):8.1f} ms")
    print(f"{'near pose':<24}{least(lambda: near_pose(cloud, start, points), repeats):8.1f} ms")
    near = near_pose(cloud, start, points).pose
    print(f"{'first fit':<24}{least(lambda: first_fit(graph, near, frame, settings), repeats):8.1f} ms")
    print(f"{'fit with all steps':<24}{least(lambda: tracking.tracking(graph, None, start, frame, settings), repeats):8.1f} ms")
    for name, spent in stages(lambda: tracking.tracking(graph, None, start, frame, settings), repeats).most_common():
        print(f"  {name:<22}{spent:8.1f} ms")
    rows = (
        *deformation.shape(graph, start),
        frame.V,
        frame.N,
        graph.sample[::2],
        frame.nearest(graph.V, graph.N)[graph.sample[::2]],
    )
    limits = graph.size, 0.04 * graph.size, 1.0
    ours = least(lambda: match_rows(*rows, *limits), 20 * repeats)
    peer = least(lambda: of_arrays(*rows, *limits), 20 * repeats)
    print(f"rows of matches{ours:10.2f} ms, numpy {peer:.2f} ms, ratio {ours / peer:.2f}")
    ours = least(lambda: morton_curve.spread_along_curve(frame.V, 6000), 10 * repeats)
    peer = least(lambda: by_lexsort(frame.V), 10 * repeats)
    print(f"samples on a curve{ours:7.2f} ms, lexsort {peer:.2f} ms, ratio {ours / peer:.2f}")


def least(call: Callable[[], object], times: int) -> float:
    """Milliseconds of processor time, the least of so many calls after the first."""
    call()
    durations = []
    for _ in range(times):
        begin = time.process_time()
        call()
        durations.append(time.process_time() - begin)
    return 1000.0 * min(durations)


def stages(call: Callable[[], object], times: int) -> "Counter[str]":
    """Milliseconds in each stage, stages within it included, in the mean of some calls."""
    spent: Counter[str] = Counter()
    originals = {(home, name): getattr(home, name) for home, names in STAGES.items() for name in names}

    def timed(function: Callable[..., Any], name: str) -> Callable[..., Any]:
        def call(*args: Any, **named: Any) -> Any:
            begin = time.process_time()
            try:
                return function(*args, **named)
            finally:
                spent[name] += 1000.0 * (time.process_time() - begin) / times  # type: ignore[assignment]

        return call

    for (home, name), function in originals.items():
        setattr(home, name, timed(function, name))
    try:
        for _ in range(times):
            call()
    finally:
        for (home, name), function in originals.items():
            setattr(home, name, function)
    return spent


def of_arrays(x: Any, n: Any, V: Any, N: Any, vertex: Any, other: Any, reach: float, scale: float, share: float) -> Any:
    """The rows of `match_rows`, array by array."""
    r, m = x[vertex] - V[other], N[other]
    alike = np.einsum("rx,rx->r", n[vertex], m)
    near = (alike > 0.5) & (np.einsum("rx,rx->r", r, r) < reach * reach)
    halfway = m + n[vertex]
    halfway /= np.maximum(np.linalg.norm(halfway, axis=1, keepdims=True), np.finfo(float).tiny)
    off = np.einsum("rx,rx->r", r, halfway)
    plane = share * alike / (1.0 + (off / scale) ** 2) ** 2
    return vertex[near], other[near], r[near], halfway[near], plane[near]


def by_lexsort(V: Any) -> Any:
    """All vertices along the curve, by numpy."""
    cell = ((V - V.min(axis=0)) / np.ptp(V, axis=0).max() * (2**morton_curve.SAMPLE_BITS - 1)).astype(np.int64)
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cell = (cell | cell << shift) & mask
    return np.lexsort((V[:, 2], V[:, 1], V[:, 0], cell @ np.array([1, 2, 4])))


if __name__ == "__main__":
    asked = [int(number) for number in sys.argv[1:]]
    main(*asked, *(6000, 5)[len(asked) :])
