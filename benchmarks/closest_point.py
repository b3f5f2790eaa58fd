"""How long the nearest points of a surface take: ours against a search that tries only the faces around near vertices.

    python benchmarks/closest_point.py [vertices]

Both are asked for the same points in one run: the vertices moved by hundredths of the size, over a ball with large faces below
and small ones above; the peer's corners are
found by scipy's kd-tree, and how many points it puts too far is counted. libigl, exact too, is asked where it is installed.
"""

import sys
import time
from collections.abc import Callable

import numba
import numpy as np
import trimesh
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.closest_point import _to_triangle, projected

CANDIDATES = 4


def main(vertices: int) -> None:
    """Prints milliseconds, ratios and how many points each puts too far."""
    ball = trimesh.creation.icosphere(3)
    while len(ball.vertices) < vertices:
        ball = ball.subdivide(face_index=np.flatnonzero(ball.triangles_center[:, 2] > -0.5))
    V, F = np.array(ball.vertices) * [1.0, 2.0, 0.5], np.array(ball.faces, np.int64)
    rng = np.random.default_rng(0)
    P = rng.permutation(V) + rng.normal(scale=0.02, size=V.shape)
    truth = projected(P, V, F).distance
    ours = milliseconds(lambda: projected(P, V, F))
    peer = milliseconds(lambda: around_vertices(P, V, F))
    too_far = int((around_vertices(P, V, F) > truth + 1e-9).sum())
    print(f"{len(P):,} points, {len(V):,} vertices, {len(F):,} faces")
    print(f"exact, tree of boxes      {ours:7.1f} ms   0 points too far")
    print(f"faces of {CANDIDATES} near vertices {peer:7.1f} ms   {too_far} points too far")
    print(f"ratio exact / near vertices {ours / peer:.2f}")
    try:
        import igl
    except ImportError:
        print("libigl                    not installed")
        return
    other = milliseconds(lambda: igl.point_mesh_squared_distance(P, V, F))
    print(f"libigl, exact             {other:7.1f} ms")
    print(f"ratio exact / libigl        {ours / other:.2f}")


def milliseconds(call: Callable[[], object], times: int = 7) -> float:
    """The least of several calls, the first left out."""
    call()
    durations = []
    for _ in range(times):
        begin = time.perf_counter()
        call()
        durations.append(time.perf_counter() - begin)
    return 1000.0 * min(durations)


def around_vertices(P: Floats, V: Floats, F: Ints) -> Floats:
    """(point,) distance to the faces around the nearest vertices."""
    near = cKDTree(V).query(P, k=CANDIDATES)[1]
    corner = np.argsort(F.ravel(), kind="stable")
    start = np.searchsorted(F.ravel()[corner], np.arange(len(V) + 1))
    return least_distance(P, V[F], near, start, corner // 3)


@numba.njit
def least_distance(P: Floats, triangle: Floats, near: Ints, start: Ints, around: Ints) -> Floats:
    """(point,) least distance to the listed faces around the listed vertices."""
    distance = np.full(len(P), np.inf)
    for i in range(len(P)):
        for k in range(near.shape[1]):
            for e in range(start[near[i, k]], start[near[i, k] + 1]):
                distance[i] = min(distance[i], _to_triangle(P[i, 0], P[i, 1], P[i, 2], triangle, around[e])[0])
    return np.sqrt(distance)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
