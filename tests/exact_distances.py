"""Exact distances over a mesh, by another program: what ours are measured against."""

import numpy as np
import pytest

from kinetree.tasks.numerics.arrays import Floats, Ints


def exact_distances(V: Floats, F: Ints, source: Ints) -> Floats:
    """(source, vertex) by pygeodesic's exact algorithm (Mitchell, Mount, Papadimitriou 1987), mesh unit."""
    peer = pytest.importorskip("pygeodesic.geodesic", reason="pygeodesic computes the exact distances")
    solver = peer.PyGeodesicAlgorithmExact(V, F.astype(np.int32))
    return np.array([solver.geodesicDistances(np.array([s]), None)[0] for s in source])
