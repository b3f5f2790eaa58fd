"""Laws of blended generalized cylinders and of their surfaces, on capsules and bends whose shape is known."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.implicit import extent, grid_values, limb_distances, nearest_limbs, values
from kinetree.tasks.numerics.input.synth.surfacing import largest_component, spacing_for, surface


def chain(*places, radius=1.0, **more):
    joints = [{"name": "j0", "position": list(places[0]), "radius": radius}]
    for k, place in enumerate(places[1:], start=1):
        joints.append({"name": f"j{k}", "parent": f"j{k - 1}", "position": list(place), "radius": radius, **more})
    return Figure.of({"name": "chain", "joints": joints})


def at_rest(figure):
    return Flesh.of(figure).at(figure.rest, np.tile(np.eye(3), (len(figure.joints), 1, 1)))


def segment_distance(P, a, b):
    t = np.clip(((P - a) @ (b - a)) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(P - a - t[:, None] * (b - a), axis=1)


def test_a_limb_of_one_radius_is_a_capsule():
    P = np.random.default_rng(1).uniform(-3, 9, (500, 3))
    field, gradient = values(at_rest(chain((0, 0, 0), (0, 0, 6))), P)
    np.testing.assert_allclose(field, segment_distance(P, np.zeros(3), np.array([0.0, 0.0, 6.0])) - 1.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(gradient, axis=1), 1.0)


def with_flesh_off(figure, off):
    """The figure with its joints moved against `off`, and its flesh left where it is."""
    joints = tuple(replace(j, position=tuple(np.subtract(j.position, off)), flesh=tuple(off)) for j in figure.joints)
    return replace(figure, joints=joints)


def test_joints_that_lie_off_their_flesh_leave_the_surface_at_rest_as_it_is():
    P = np.random.default_rng(8).uniform(-3, 9, (500, 3))
    amid = chain((0, 0, 0), (0, 0, 3), (0, 0.5, 6))
    behind = with_flesh_off(amid, (0.0, -0.7, 0.2))
    np.testing.assert_allclose(values(at_rest(behind), P)[0], values(at_rest(amid), P)[0], atol=1e-12)


def test_flesh_off_a_joint_turns_about_the_joint():
    off = np.array([0.0, -0.7, 0.0])
    behind, Q = with_flesh_off(chain((0, 0, 0), (0, 0, 6)), off), Rotation.from_euler("x", 50, degrees=True).as_matrix()
    pivot = np.array(behind.joints[0].position)
    P = np.random.default_rng(9).uniform(-3, 9, (500, 3))
    X = pivot + (behind.rest - pivot) @ Q.T
    turned = Flesh.of(behind).at(X, np.tile(Q, (2, 1, 1)))
    np.testing.assert_allclose(values(turned, pivot + (P - pivot) @ Q.T)[0], values(at_rest(behind), P)[0], atol=1e-12)


def test_a_straight_limb_of_several_bones_has_no_bulge_at_its_joints():
    P = np.random.default_rng(2).uniform(-3, 9, (500, 3))
    whole, _ = values(at_rest(chain((0, 0, 0), (0, 0, 6))), P)
    parts, _ = values(at_rest(chain((0, 0, 0), (0, 0, 2), (0, 0, 6))), P)
    outside = whole > -0.5
    np.testing.assert_allclose(parts[outside], whole[outside], atol=0.02)


def test_a_bend_is_filled_on_its_inner_side_and_nowhere_else():
    P = np.random.default_rng(3).uniform(-3, 7, (4000, 3))
    a, b, c = np.array([0.0, 0, 5]), np.zeros(3), np.array([5.0, 0, 0])
    union = np.minimum(segment_distance(P, a, b), segment_distance(P, b, c)) - 1.0
    field, _ = values(at_rest(chain(a, b, c)), P)
    assert (field <= union + 1e-12).all()
    filled = field < union - 1e-6
    assert filled.any()
    assert (P[filled][:, 0] + P[filled][:, 2] > 0.0).all()
    # There both limbs are 0.1 away and their gradients at right angles: half the blend's width of 0.7, at full strength.
    crease = values(at_rest(chain(a, b, c)), np.array([[1.1, 0.0, 1.1]]))[0]
    np.testing.assert_allclose(crease, 0.1 - 0.25 * 0.5 * 0.7, atol=1e-12)


def test_limbs_that_are_not_neighbours_do_not_blend():
    comb = chain((0, 0, 6), (0, 0, 0), (3, 0, 0), (3, 0, 6))
    P = np.random.default_rng(4).uniform((-2, -2, 3), (5, 2, 8), (500, 3))
    outer = np.minimum(
        segment_distance(P, np.array([0.0, 0, 6]), np.zeros(3)),
        segment_distance(P, np.array([3.0, 0, 0]), np.array([3.0, 0, 6])),
    )
    np.testing.assert_allclose(values(at_rest(comb), P)[0], outer - 1.0, atol=1e-12)


def test_a_flat_limb_keeps_its_share_of_the_radius_along_its_side():
    cones = at_rest(chain((0, 0, 0), (0, 0, 6), flatten=0.5, side=[0, 1, 0.3]))
    field, _ = values(cones, np.array([[1.0, 0, 3], [0, 0.5, 3], [0, -0.5, 3], [0, 0, 3.0]]))
    np.testing.assert_allclose(field, [0.0, 0.0, 0.0, -0.5], atol=1e-12)


def test_a_profile_runs_through_its_radii():
    figure = Figure.of(
        {
            "joints": [
                {"name": "a", "position": [0, 0, 0], "radius": 1},
                {"name": "b", "parent": "a", "position": [0, 0, 8], "radii": [1.0, 1.5, 0.7, 0.6, 0.5]},
            ]
        }
    )
    P = np.array([[1.0, 0, 0], [1.5, 0, 2], [0.7, 0, 4], [0.6, 0, 6], [0.5, 0, 8]])
    np.testing.assert_allclose(values(at_rest(figure), P)[0], 0.0, atol=1e-12)


def test_the_sparse_grid_is_the_field_wherever_it_is_near_the_surface():
    cones = at_rest(chain((0, 0, 5), (0, 0, 0), (4, 1, 0), (6, 1, 4), radius=0.8))
    low, high = extent(cones)
    origin, spacing, band = low - 1.0, 0.31, 0.5
    shape = tuple(int(n) for n in np.ceil((high - low + 2.0) / spacing))
    grid = grid_values(cones, origin, spacing, shape, band)
    P = origin + spacing * np.argwhere(np.ones(shape))
    np.testing.assert_allclose(grid.ravel(), np.clip(values(cones, P)[0], -band, band), atol=1e-12)


def test_an_absent_limb_leaves_the_others_as_they_are():
    figure = chain((0, 0, 5), (0, 0, 0), (4, 0, 0))
    flesh = Flesh.of(figure)
    eye = np.tile(np.eye(3), (3, 1, 1))
    P = np.random.default_rng(5).uniform(-2, 6, (200, 3))
    alone = values(at_rest(chain((0, 0, 5), (0, 0, 0))), P)[0]
    np.testing.assert_allclose(values(flesh.at(figure.rest, eye, np.array([False, True])), P)[0], alone, atol=1e-12)


def test_points_past_a_joint_belong_to_the_limb_beside_them():
    distances = limb_distances(at_rest(chain((0, 0, 0), (0, 0, 4), (0, 0, 8))), np.array([[1.0, 0, 3.5], [1.0, 0, 4.5]]))
    assert distances.argmin(axis=1).tolist() == [0, 1]


def test_far_limbs_are_passed_over_and_none_that_could_be_nearest():
    figure = chain((0, 0, 0), (0, 0, 4), (3, 0, 5), (3, 3, 5), (0, 6, 1), (2, 0, 2))
    cones = at_rest(figure)
    bent = np.random.default_rng(8).normal(scale=0.4, size=cones.bow.shape)
    folds = np.column_stack([np.full(len(bent), 5.0), np.full(len(bent), 0.3), np.arange(len(bent))])
    P = np.random.default_rng(9).uniform(-3, 8, (3000, 3))
    for body in (cones, cones._replace(bow=bent), cones._replace(flat=np.full(len(bent), 0.4)), cones._replace(folds=folds)):
        np.testing.assert_array_equal(nearest_limbs(body, P), limb_distances(body, P).argmin(axis=1))


def test_a_surfaced_capsule_lacks_volume_in_proportion_to_a_voxels_face():
    cones = at_rest(chain((0, 0, 0), (0, 0, 6)))
    lacking = []
    for vertices in (1500, 6000):
        V, F = surface(cones, spacing_for(cones, vertices), np.random.default_rng(6), vertices)
        solid = trimesh.Trimesh(V, F, process=False)
        assert solid.is_watertight
        assert len(V) == pytest.approx(vertices, rel=0.05)
        assert solid.area_faces.min() > 0.0
        lacking.append(1.0 - solid.volume / (np.pi * 6.0 + 4.0 / 3.0 * np.pi))
    assert 0.0 < lacking[1] < 0.01
    assert lacking[0] / lacking[1] == pytest.approx(4.0, rel=0.15)


def test_of_pockets_specks_and_the_solid_only_the_solid_remains():
    ball, pocket = trimesh.creation.icosphere(subdivisions=2, radius=3.0), trimesh.creation.icosphere(subdivisions=3)
    pocket.invert()
    speck = trimesh.creation.icosphere(subdivisions=1, radius=0.1).apply_translation([6.0, 0.0, 0.0])
    whole = trimesh.util.concatenate([pocket, ball, speck])
    V, F = largest_component(np.array(whole.vertices), np.array(whole.faces))
    np.testing.assert_array_equal(V, ball.vertices)
    np.testing.assert_array_equal(F, ball.faces)
