"""Vertices at one place made one: exported meshes have seams along which every vertex stands twice."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Faces, Floats


def welded(X: Floats, tolerance: float) -> Faces:
    """For every vertex the first vertex at its place.

    Closeness is carried along chains, so that the vertices that stay are further apart than `tolerance`.

    X         : (vertex, xyz)
    tolerance : in the unit of X; 0 welds equal coordinates only
    returns   : (vertex,) the first vertex of the cluster, itself if alone
    """
    order = np.lexsort(X.T)
    new = np.r_[True, (np.diff(X[order], axis=0) != 0).any(axis=1)]
    cluster = np.empty(len(X), dtype=np.int64)
    cluster[order] = np.cumsum(new) - 1
    # equal vertices are one before any pair is listed: ten thousand at one place would be fifty million pairs
    place = X[order[new]]
    if tolerance > 0:
        tree = cKDTree(place, balanced_tree=False)
        i, j = tree.query_pairs(tolerance, output_type="ndarray").T
        near = coo_array((np.ones(len(i), dtype=bool), (i, j)), shape=(len(place), len(place)))
        cluster = connected_components(near, directed=False)[1][cluster]
    first = np.full(int(cluster.max()) + 1, len(X), dtype=np.int32)
    np.minimum.at(first, cluster, np.arange(len(X), dtype=np.int32))
    return first[cluster]
