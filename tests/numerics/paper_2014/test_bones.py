"""Laws of areas, joints and bones."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2014.bones import (
    adjacent,
    area_centroids,
    bones,
    candidates,
    interval_labels,
    joint_adjacency,
    length_variation,
    rigid_parts,
)
from kinetree.tasks.numerics.paper_2014.cylinders import Areas, Cylinder, areas

V, F = tube()
ANNULUS = np.minimum(((V[:, 2] + 5.0) / 1.0).astype(int), 9)


def marks(text):
    return np.array([c == "#" for c in text])


def test_contiguous_annuli_of_one_kind_are_one_area():
    partition = areas([Cylinder(0, ANNULUS, marks("##..###.##"))], len(V), F)
    assert partition.rigid.tolist() == [True, False, True, False, True]
    assert partition.first_annulus.tolist() == [0, 2, 4, 7, 8]
    assert partition.last_annulus.tolist() == [1, 3, 6, 7, 9]
    assert (partition.label == np.array([0, 0, 1, 1, 2, 2, 2, 3, 4, 4])[ANNULUS]).all()


def test_vertex_in_no_cylinder_has_the_area_beside_it():
    annulus = np.where(ANNULUS == 5, -1, ANNULUS)
    partition = areas([Cylinder(0, annulus, marks("#####.####"))], len(V), F)
    assert (partition.label >= 0).all()
    assert partition.rigid.all()


def test_body_without_cones_is_one_rigid_area():
    partition = areas([], len(V), F)
    assert (partition.label == 0).all()
    assert partition.rigid.tolist() == [True]


def test_rigid_areas_without_a_joint_between_them_are_one_part():
    low, high = np.where(ANNULUS < 4, ANNULUS, -1), np.where(ANNULUS >= 4, ANNULUS - 4, -1)
    partition = areas([Cylinder(0, low, marks("#.##")), Cylinder(1, high, marks("##.###"))], len(V), F)
    adjacency = adjacent(partition.label, F, len(partition.rigid))
    assert partition.rigid.tolist() == [True, False, True, True, False, True]
    assert rigid_parts(adjacency, partition.rigid).tolist() == [0, -1, 1, 1, -1, 2]


def test_bones_join_joints_of_one_part_and_joints_that_touch():
    partition = areas([Cylinder(0, ANNULUS, marks("##.##.##.#"))], len(V), F)
    adjacency = adjacent(partition.label, F, len(partition.rigid))
    bone, bone_part = candidates(adjacency, rigid_parts(adjacency, partition.rigid))
    assert bone.tolist() == [[1, 3], [3, 5]]
    assert bone_part.tolist() == [1, 2]
    low, high = np.where(ANNULUS < 5, ANNULUS, -1), np.where(ANNULUS >= 5, ANNULUS - 5, -1)
    partition = areas([Cylinder(0, low, marks("####.")), Cylinder(1, high, marks(".####"))], len(V), F)
    adjacency = adjacent(partition.label, F, len(partition.rigid))
    bone, bone_part = candidates(adjacency, rigid_parts(adjacency, partition.rigid))
    assert bone.tolist() == [[1, 2]]
    assert bone_part.tolist() == [-1]


def test_joints_beside_a_part_are_those_of_its_neighbouring_areas():
    adjacency = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], bool)
    assert joint_adjacency(adjacency, np.array([0, -1, 1])).tolist() == [[False, True, False], [False, True, False]]
    assert joint_adjacency(adjacency, np.full(3, -1)).shape == (0, 3)


def test_body_of_joints_alone_and_body_without_joints_have_no_bones():
    none = np.zeros((1, 1), bool)
    assert rigid_parts(none, np.array([True])).tolist() == [0]
    assert rigid_parts(none, np.array([False])).tolist() == [-1]
    assert len(candidates(none, np.array([-1]))[0]) == 0
    assert len(candidates(none, np.array([0]))[0]) == 0


def test_spanning_tree_drops_the_bone_of_a_triangle_whose_length_varies_most():
    t = np.linspace(0.0, 1.0, 9)
    a, b = np.zeros((9, 3)), np.zeros((9, 3))
    b[:, 0] = 2.0
    c = np.stack([2.0 + np.sin(t), np.cos(t), 0 * t], axis=1)  # keeps its distance from b, not from a
    triangle = np.array([[0, 1, 2]])
    tree = bones(np.array([0, 1, 2]), np.zeros(3, bool), triangle, np.stack([a, b, c], axis=1))
    assert tree.bone.tolist() == [[0, 1], [0, 2], [1, 2]]
    assert tree.in_tree.tolist() == [True, False, True]
    assert tree.variation[[0, 2]].max() < 1e-12
    assert tree.part.tolist() == [-1, -1, -1]


def test_frames_in_which_a_joint_is_not_seen_do_not_count():
    X = np.zeros((4, 2, 3))
    X[:, 1, 0] = [1.0, 1.0, np.nan, 1.0]
    assert length_variation(X, np.array([[0, 1]])).tolist() == [0.0]
    X[:, 1, 0] = np.nan
    assert length_variation(X, np.array([[0, 1]])).tolist() == [np.inf]


STRIP = Areas(
    np.array([0, 0, 1, 1, 2, 2]), np.array([True, False, True]), np.array([0, 0, 1]), np.array([0, 2, 0]), np.array([1, 3, 1])
)


def test_areas_of_cones_are_known_by_annulus_and_others_over_the_cuts():
    model_vertex = np.array([5, 4, 3, 2, 1, 0, -1])
    annulus = np.array([[-1, -1, 3, 3, 2, 1, 0]])
    assert interval_labels(STRIP, 1, annulus, model_vertex).tolist() == [2, 2, 1, 1, 1, 0, 0]


def test_vertex_of_a_cone_that_its_own_interval_does_not_put_there_is_unknown():
    assert interval_labels(STRIP, 1, np.full((1, 2), -1), np.array([0, 4])).tolist() == [-1, 2]


def test_vertex_in_two_cones_has_its_area_over_the_cuts():
    both = Areas(np.array([0, 1]), np.ones(2, bool), np.array([0, 1]), np.zeros(2, int), np.ones(2, int))
    assert interval_labels(both, 2, np.zeros((2, 1), int), np.array([1])).tolist() == [1]


def test_centroid_is_of_the_surface_and_only_of_areas_that_are_seen():
    x = np.array([[[0.0, 0, 0], [4.0, 0, 0], [9.0, 9, 9]]])
    centroid = area_centroids(x, np.array([0, 0, -1]), np.array([3.0, 1.0, 1.0]), 2)
    assert centroid[0, 0].tolist() == [1.0, 0.0, 0.0]
    assert np.isnan(centroid[0, 1]).all()
