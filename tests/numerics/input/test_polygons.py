"""Polygons kept in rows of numbers become the triangles that trimesh makes of a list of lists, in its order."""

from array import array

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st
from trimesh.geometry import triangulate_quads

from kinetree.tasks.numerics.input.polygons import triangles_of

POLYGONS = st.lists(st.lists(st.integers(-5, 2**40), min_size=3, max_size=7), max_size=12)


@given(POLYGONS)
@example([[1, 2, 3], [4, 5, 6]])
@example([[1, 2, 3, 4], [5, 6, 7, 8]])
@example([[1, 2, 3, 4, 5], [5, 6, 7, 8, 9]])
def test_triangles_are_those_of_trimesh_in_its_order(polygons):
    corners, counts = array("q", [c for polygon in polygons for c in polygon]), array("q", map(len, polygons))
    F, polygon_of = triangles_of(corners, counts)
    np.testing.assert_array_equal(F, np.asarray(triangulate_quads(polygons), dtype=np.int64).reshape(-1, 3))
    assert all(set(face) <= set(polygons[p]) for face, p in zip(F.tolist(), polygon_of, strict=True))
