"""Which joints are laid with a hinge at several places, which of their points, and on which side of it."""

import numpy as np
import pytest
from smeared import END, Frames, three_parts, turning

from kinetree.tasks.numerics.arrays import Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.hinge_costs import HingedLimb, hinge_costs, hinged_limbs
from kinetree.tasks.numerics.structure.hinge_places import HingePlacesSettings
from kinetree.tasks.numerics.structure.part_tree import MovingSurface

EVERY = HingePlacesSettings(points=10**6)
"""All points of the parts, so that they can be counted."""


def tube() -> tuple[MovingSurface, FirstTree]:
    """A tube of radius 1 and of three parts, its joints on the axis at 0 and `END`; every vertex follows its part alone."""
    surface, joints = three_parts(16)
    tree = in_tree_order(joints, 3)
    rest = np.array([tree.rest[0], [0.0, 0.0, 0.0], [0.0, 0.0, END]])
    return surface, tree._replace(rest=rest, radius=np.ones(3), W=np.eye(3)[tree.label])


def limbs(surface: MovingSurface, tree: FirstTree) -> dict[int, HingedLimb]:
    return {limb.joint: limb for limb in hinged_limbs(surface.V, surface.F, surface.area, tree, EVERY)}


def last_part_of(surface: MovingSurface, tree: FirstTree, count: int) -> Ints:
    """(vertex,) labels with which the last part has so many vertices, those that are highest."""
    label, high = np.minimum(tree.label, 1), np.argsort(-surface.V[:, 2], kind="stable")
    label[high[:count]] = 2
    return label


@pytest.mark.parametrize(("length", "is_laid"), [(0.22, False), (0.26, True)])
def test_a_joint_is_laid_where_its_bones_are_nearly_as_long_as_short_ones_may_be(length: float, is_laid: bool) -> None:
    surface, tree = tube()
    rest = tree.rest.copy()
    rest[1, 2] = END - length
    assert (2 in limbs(surface, tree._replace(rest=rest))) is is_laid


@pytest.mark.parametrize(("cosine", "is_laid"), [(0.28, False), (0.36, True)])
def test_a_joint_is_laid_where_its_bones_are_nearly_straight_enough(cosine: float, is_laid: bool) -> None:
    surface, tree = tube()
    bone = np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    rest = tree.rest.copy()
    rest[1] = rest[2] - 3.0 * bone
    assert (2 in limbs(surface, tree._replace(rest=rest))) is is_laid


@pytest.mark.parametrize(("cosine", "is_laid"), [(0.52, False), (0.6, True)])
def test_short_bones_must_be_straighter(cosine: float, is_laid: bool) -> None:
    surface, tree = tube()
    rest = tree.rest.copy()
    rest[1] = rest[2] - 0.8 * np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    assert (2 in limbs(surface, tree._replace(rest=rest))) is is_laid


def test_points_change_sides_as_far_as_four_radii_from_the_joint() -> None:
    surface, tree = tube()
    limb = limbs(surface, tree)[2]
    height, places = limb.V[:, 2] - END, EVERY.places
    assert np.linalg.norm(limb.V - tree.rest[2], axis=1).max() < 4.0
    np.testing.assert_array_equal(limb.far[0], height > places[:, None])


def test_points_farther_than_four_radii_stay_on_the_side_of_their_part() -> None:
    surface, tree = tube()
    V = surface.V.copy()
    aside = (tree.label == 1) & (V[:, 2] < 0.5)
    V[aside] += [5.0, 0.0, END]
    limb = limbs(surface._replace(V=V), tree)[2]
    away = np.linalg.norm(limb.V - tree.rest[2], axis=1)
    assert aside.sum() > 20
    assert (limb.V[away > 4.0, 2] > END).all()
    assert not limb.far[:, :, away > 4.0].any()


def test_points_follow_mostly_the_two_parts() -> None:
    surface, tree = tube()
    W, half = tree.W.copy(), (tree.label == 1) & (surface.V[:, 0] > 0.0)
    for share, is_laid in ((0.7, False), (0.8, True)):
        W[half, 1], W[half, 0] = share, 1.0 - share
        count = len(limbs(surface, tree._replace(W=W))[2].V)
        assert count == (tree.label > 0).sum() - (0 if is_laid else half.sum())


@pytest.mark.parametrize(("count", "is_laid"), [(7, False), (9, True)])
def test_a_joint_is_laid_where_eight_points_lie_on_either_side(count: int, is_laid: bool) -> None:
    surface, tree = tube()
    assert (2 in limbs(surface, tree._replace(label=last_part_of(surface, tree, count)))) is is_laid


def test_a_place_with_few_points_on_a_side_costs_most() -> None:
    surface, tree = tube()
    target = Target.of(*Frames(turning()[:16])(0), surface.size)
    square = hinge_costs(surface.V, surface.F, surface.area, tree, {0: target}, EVERY).square[0, -1, 0]
    far = limbs(surface, tree)[2].far[0]
    fewer = np.minimum(far.sum(axis=1), (~far).sum(axis=1))
    np.testing.assert_array_equal(np.isclose(square, square.max()), fewer < 8)
