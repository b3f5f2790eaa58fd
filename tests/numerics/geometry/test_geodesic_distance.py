"""Laws of geodesic distance on shapes whose distances are known in closed form."""

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import shapes
import trimesh
from exact_distances import exact_distances

from kinetree.errors import MeshError
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def relative_error(V: Floats, F: Ints, source: Ints, exact: Floats) -> Floats:
    """Signed, at vertices more than four mean edges from their source: nearer, one edge's worth is all there is."""
    surface = Surface.of(V, F)
    distance = geodesic_distance(surface, source)
    far = exact > 4 * surface.edge
    assert far.any()
    return (distance - exact)[far] / exact[far]


def straight(V: Floats, source: Ints) -> Floats:
    return np.linalg.norm(V[source][:, None] - V[None], axis=2)


def rotation(rng: np.random.Generator) -> Floats:
    Q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return Q * np.linalg.det(Q)


def test_on_a_flat_grid_distance_is_the_straight_line() -> None:
    V, F = shapes.flat_grid(40, 40)
    source = np.arange(0, len(V), 177)
    error = relative_error(V, F, source, straight(V, source))
    assert error.min() > -1e-5
    assert error.mean() < 0.004
    assert error.max() < 0.01


@pytest.mark.parametrize("shear", [0.5, 1.5, 3.0])
def test_obtuse_triangles_do_not_lengthen_straight_lines(shear: float) -> None:
    V, F = shapes.flat_grid(40, 40, shear)
    source = np.arange(0, len(V), 177)
    error = np.abs(relative_error(V, F, source, straight(V, source)))
    assert error.mean() < 0.005
    assert error.max() < 0.02


def test_on_a_cylinder_distance_is_the_straight_line_on_its_unrolled_sides() -> None:
    V, F = shapes.open_cylinder(48, 31)
    source = np.arange(0, len(V), 165)
    error = np.abs(relative_error(V, F, source, np.array([shapes.over_cylinder(V, int(s), 48) for s in source])))
    assert error.mean() < 0.005
    assert error.max() < 0.02


def test_on_a_sphere_distance_is_the_angle() -> None:
    V, F = shapes.sphere(4)
    source = np.arange(0, len(V), 365)
    error = np.abs(relative_error(V, F, source, np.arccos(np.clip(V[source] @ V.T, -1, 1))))
    assert error.mean() < 0.005
    assert error.max() < 0.02


def test_on_a_sphere_error_is_no_larger_for_finer_triangles() -> None:
    for subdivisions in (3, 4, 5):
        V, F = shapes.sphere(subdivisions)
        source = np.arange(12)
        assert np.abs(relative_error(V, F, source, np.arccos(np.clip(V[source] @ V.T, -1, 1)))).mean() < 0.0025


@pytest.mark.parametrize("angle", [0.5, 1.5, 2.5, 3.1])
def test_folding_a_strip_changes_no_distance(angle: float) -> None:
    V, F = shapes.flat_grid(80, 12)
    source = np.arange(0, len(V), 101)
    error = np.abs(relative_error(shapes.folded(V, 40.0, angle), F, source, straight(V, source)))
    assert error.mean() < 0.005
    assert error.max() < 0.02


def test_across_an_edge_of_three_faces_any_two_pages_are_flat_once_opened() -> None:
    V, F, page = shapes.three_pages(20, 30)
    source = np.arange(0, len(V), 171)
    r, z = np.hypot(V[:, 0], V[:, 1]), V[:, 2]
    apart = (page[source][:, None] != page) & (page >= 0) & (page[source] >= 0)[:, None]
    opened = np.hypot(r[source][:, None] + r, z[source][:, None] - z)
    error = np.abs(relative_error(V, F, source, np.where(apart, opened, straight(V, source))))
    assert error.mean() < 0.005
    assert error.max() < 0.02


def test_faces_of_mixed_orientation_keep_their_distances() -> None:
    V, F = shapes.sphere(4)
    turned = F.copy()
    turned[::3] = turned[::3, ::-1]
    source = np.arange(0, len(V), 365)
    exact = np.arccos(np.clip(V[source] @ V.T, -1, 1))
    error = np.abs(relative_error(V, turned, source, exact))
    assert error.mean() < 0.01
    assert error.max() < 0.05


def test_where_two_balls_touch_every_path_from_one_to_the_other_passes() -> None:
    V, F = shapes.sphere(3)
    both = np.concatenate([F, np.where(F == 0, 0, F + len(V))])
    g = geodesic_distance(Surface.of(np.concatenate([V, 2 * V[0] - V]), both), [0, 100])
    used = np.delete(np.arange(2 * len(V)), len(V))
    other = used[used > len(V)]
    assert np.allclose(g[1, other], g[1, 0] + g[0, other], rtol=1e-6)


def test_distance_is_symmetric() -> None:
    V, F, _ = shapes.y_pipe()
    surface = Surface.of(V, F)
    g = geodesic_distance(surface, np.arange(len(V)))
    far = g > 4 * surface.edge
    error = np.abs(g - g.T)[far] / g[far]
    assert error.mean() < 0.005
    assert error.max() < 0.02
    assert np.all(np.diag(g) == 0)


def test_the_triangle_inequality_holds_up_to_the_error() -> None:
    V, F = shapes.sphere(3)
    surface = Surface.of(V, F)
    g = geodesic_distance(surface, np.arange(len(V)))
    over = g[:, :, None] - (g[:, None, ::7] + g[::7].T[None])
    assert over.max() < 0.5 * surface.edge


def test_no_path_is_shorter_than_space_nor_longer_than_the_edges() -> None:
    V, F, _ = shapes.y_pipe()
    source = np.array([0, 500, 1000])
    g = geodesic_distance(Surface.of(V, F), source)
    edges = np.unique(np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    length = np.linalg.norm(V[edges[:, 0]] - V[edges[:, 1]], axis=1)
    assert np.all(g >= straight(V, source) * (1 - 1e-6))
    for s in range(len(source)):
        assert np.all(np.abs(g[s, edges[:, 0]] - g[s, edges[:, 1]]) <= length * (1 + 1e-6))


def test_scaling_by_a_power_of_two_scales_every_bit() -> None:
    V, F = shapes.sphere(3)
    assert np.array_equal(geodesic_distance(Surface.of(8 * V, F), [5]), 8 * geodesic_distance(Surface.of(V, F), [5]))


def test_moving_and_turning_the_body_changes_nothing() -> None:
    V, F, _ = shapes.y_pipe()
    moved = V @ rotation(np.random.default_rng(1)).T + [3.0, -70.0, 11.0]
    still = geodesic_distance(Surface.of(V, F), [10, 400])
    error = np.abs(geodesic_distance(Surface.of(moved, F), [10, 400]) - still)
    assert error.mean() < 1e-3 * still.mean()


def test_renumbering_vertices_and_faces_renumbers_the_distances() -> None:
    rng = np.random.default_rng(2)
    V, F = shapes.sphere(3)
    new, face = rng.permutation(len(V)), rng.permutation(len(F))
    W = np.empty_like(V)
    W[new] = V
    g = geodesic_distance(Surface.of(V, F), [7])[0]
    assert np.abs(geodesic_distance(Surface.of(W, new[F][face]), [new[7]])[0, new] - g).max() < 1e-3 * g.max()


def test_each_source_is_alone_whatever_else_is_asked() -> None:
    V, F = shapes.sphere(3)
    surface = Surface.of(V, F)
    together = geodesic_distance(surface, [3, 100, 3, 641])
    for row, source in zip(together, [3, 100, 3, 641], strict=True):
        assert np.array_equal(row, geodesic_distance(surface, [source])[0])


def test_threads_at_the_same_time_get_the_same_bits() -> None:
    surface = Surface.of(*shapes.sphere(4))
    alone = geodesic_distance(surface, np.arange(40))
    with ThreadPoolExecutor(4) as pool:
        at_once = list(pool.map(lambda s: geodesic_distance(surface, [s])[0], range(40)))
    assert np.array_equal(np.array(at_once), alone)


def test_another_component_is_infinitely_far() -> None:
    V, F = shapes.two_components()
    g = geodesic_distance(Surface.of(V, F), [0])[0]
    half = len(V) // 2
    assert np.isfinite(g[:half]).all()
    assert np.isinf(g[half:]).all()


def test_a_vertex_without_faces_is_reached_by_nothing_but_itself() -> None:
    V, F = shapes.flat_grid(4, 4)
    surface = Surface.of(np.concatenate([V, [[9.0, 9.0, 9.0]]]), F)
    g = geodesic_distance(surface, [0, 16])
    assert np.isinf(g[0, 16])
    assert g[1, 16] == 0
    assert np.isinf(g[1, :16]).all()


def test_within_the_radius_nothing_changes_and_beyond_it_all_is_infinite() -> None:
    V, F = shapes.sphere(4)
    surface = Surface.of(V, F)
    whole, near = geodesic_distance(surface, [0])[0], geodesic_distance(surface, [0], radius=1.0)[0]
    assert np.array_equal(near, np.where(whole <= 1.0, whole, np.inf))
    assert 0 < np.isfinite(near).sum() < len(V)


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ([], "no source"),
        ([0, 9], r"source 1 is vertex 9, but the mesh has 9 vertices; number them from 0 to 8"),
        ([-1], r"source 0 is vertex -1, but the mesh has 9 vertices"),
        ([0.5], "float64; pass integers"),
    ],
)
def test_a_source_that_is_no_vertex_is_refused(source: list[float], words: str) -> None:
    V, F = shapes.flat_grid(3, 3)
    with pytest.raises(MeshError, match=words):
        geodesic_distance(Surface.of(V, F), source)


def test_exact_distances_of_another_program_are_met_on_a_rough_body_with_a_sharp_rim() -> None:
    V, F, _ = shapes.y_pipe(arm=40, half_width=7)
    V = V + np.random.default_rng(3).normal(scale=0.08, size=V.shape)
    source = np.arange(0, len(V), 400)
    exact = exact_distances(V, F, source)
    error = np.abs(relative_error(V, F, source, exact))
    assert error.mean() < 0.005
    assert np.quantile(error, 0.999) < 0.02
    surface = Surface.of(V, F)
    assert np.abs(geodesic_distance(surface, source) - exact).max() < 1.5 * surface.edge


@pytest.mark.data
def test_exact_distances_are_met_on_a_surfaced_body() -> None:
    folder = os.environ.get("KINETREE_SEQUENCES")
    if folder is None or not (Path(folder) / "wave").is_dir():
        pytest.skip("KINETREE_SEQUENCES names no folder that holds the sequence wave as PLY files")
    for path in sorted((Path(folder) / "wave").glob("*.ply"))[::18]:
        mesh = trimesh.load(path, process=False)
        V, F = np.array(mesh.vertices, np.float64), np.array(mesh.faces, np.int64)
        source = np.arange(0, len(V), 3000)
        exact = exact_distances(V, F, source)
        error = np.abs(relative_error(V, F, source, exact))
        assert error.mean() < 0.005
        assert error.max() < 0.02
        assert np.abs(geodesic_distance(Surface.of(V, F), source) - exact).max() < 0.02 * exact.mean()
