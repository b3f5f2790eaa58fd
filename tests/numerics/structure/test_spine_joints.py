"""Laws of the places of a person's spine."""

import numpy as np
import pytest
import trimesh
from walkers import Walker, turned, walker

from kinetree.tasks.numerics.structure.limbs import Limb
from kinetree.tasks.numerics.structure.spine_joints import SpineJointsSettings, spine, spine_shifts

RADIUS = 100.0
DEPTH = 180.0
"""Of the trunk, mm: of bodies' it is 1.4 to 1.9 radii of the borders."""


@pytest.fixture(scope="module")
def person() -> Walker:
    return walker("human")


def _trunk(
    depth: float = DEPTH, middle: float = 0.0, breadth: float = 4000.0, aside: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """A box about every spine, whose middle lies at an x and a y; the person faces −y. It is broader than trunks are."""
    box = trimesh.creation.box((breadth, depth, 4000.0))
    return np.array(box.vertices) + (aside, middle, 0.0), np.array(box.faces)


def _spine(body: Walker) -> list[int]:
    return [body.names.index(name) for name in ("spine", "chest")]


def _upright(body: Walker) -> Walker:
    """With the joints of the trunk in one plane, so that it faces −y at each of them."""
    rest = body.motion.rest.copy()
    rest[:, 1] = 0.0
    return body._replace(motion=body.motion._replace(rest=rest))


NOWHERE = np.zeros((0, 3)), np.zeros((0, 3), np.int64)
"""A surface that no line meets."""


def _radius(body: Walker) -> np.ndarray:
    return np.where(body.ends, 0.0, RADIUS)


def test_without_a_depth_the_spine_goes_back_by_its_share_of_the_radius_and_nothing_else_moves(person):
    shift = spine_shifts(*NOWHERE, person.motion, _radius(person))
    np.testing.assert_allclose(np.linalg.norm(shift[_spine(person)], axis=1), RADIUS * SpineJointsSettings().behind)
    assert (shift[_spine(person), 1] > 0.95 * 25.0).all(), "it faces −y"
    assert not np.delete(shift, _spine(person), axis=0).any()


@pytest.mark.parametrize("middle", [-50.0, 0.0, 30.0])
def test_it_goes_half_of_the_way_to_a_third_of_the_depth_and_half_of_that_by_its_radius(person, middle):
    body, chosen = _upright(person), SpineJointsSettings()
    shift = spine_shifts(*_trunk(middle=middle), body.motion, _radius(body))[_spine(body)]
    at_third = middle + DEPTH / 2.0 - DEPTH / 3.0
    np.testing.assert_allclose(shift[:, 1], (chosen.behind * RADIUS + at_third) / 2.0, rtol=1e-6)
    np.testing.assert_allclose(shift[:, [0, 2]], 0.0, atol=1e-6)


def test_too_far_back_it_comes_forwards(person):
    body = _upright(person)
    assert (spine_shifts(*_trunk(middle=-80.0), body.motion, _radius(body))[_spine(body), 1] < 0.0).all()


@pytest.mark.parametrize(("radii", "counts"), [(0.98, False), (1.02, True), (2.48, True), (2.52, False)])
def test_what_is_not_as_deep_as_a_trunk_says_nothing(person, radii, counts):
    body = _upright(person)
    shift = spine_shifts(*_trunk(radii * RADIUS, middle=10.0), body.motion, _radius(body))
    without = spine_shifts(*NOWHERE, body.motion, _radius(body))
    assert np.allclose(shift, without) is not counts


@pytest.mark.parametrize("aside", [-30.0, 40.0])
def test_it_goes_half_of_the_way_to_the_middle_from_side_to_side(person, aside):
    body = _upright(person)
    plain = spine_shifts(*_trunk(), body.motion, _radius(body))[_spine(body)]
    shift = spine_shifts(*_trunk(breadth=220.0, aside=aside), body.motion, _radius(body))[_spine(body)]
    np.testing.assert_allclose(shift - plain, [[aside / 2.0, 0.0, 0.0]] * 2, atol=1e-6)


@pytest.mark.parametrize(("radii", "counts"), [(1.48, False), (1.52, True), (2.78, True), (2.82, False)])
def test_what_is_not_as_broad_as_a_trunk_says_nothing_of_its_middle(person, radii, counts):
    body = _upright(person)
    shift = spine_shifts(*_trunk(breadth=radii * RADIUS, aside=20.0), body.motion, _radius(body))
    plain = spine_shifts(*_trunk(), body.motion, _radius(body))
    assert np.allclose(shift, plain, atol=1e-6) is not counts


def test_the_middle_is_that_of_the_trunk_at_the_depth_where_the_joint_goes(person):
    body, (V, F) = _upright(person), _trunk(breadth=220.0)
    V = V + np.array([1.0, 0.0, 0.0]) * V[:, 1:2]
    there = spine_shifts(V, F, body.motion, _radius(body))[_spine(body)]
    np.testing.assert_allclose(there[:, 0], there[:, 1] / 2.0, atol=1e-6)
    assert (there[:, 1] > 10.0).all()


def test_a_joint_does_not_go_through_the_back(person):
    body = _upright(person)
    shift = spine_shifts(*_trunk(0.9 * RADIUS, middle=-35.0), body.motion, _radius(body))[_spine(body), 1]
    np.testing.assert_allclose(shift, 10.0, rtol=1e-6, err_msg="the back is 10 mm behind it, and too near to the front")


def test_arms_beside_a_joint_that_is_outside_or_on_the_back_say_nothing(person):
    body = _upright(person)
    for trunk in (_trunk(middle=200.0), _trunk(0.9 * RADIUS, middle=-35.0)):
        (V, F), arms = trunk, [trimesh.creation.box((40.0, 400.0, 4000.0)) for _ in range(2)]
        arms[0].apply_translation((150.0, 0.0, 0.0))
        arms[1].apply_translation((-100.0, 0.0, 0.0))
        beside = [np.array(arm.vertices) for arm in arms]
        faces = [np.array(arm.faces) + len(V) + 8 * k for k, arm in enumerate(arms)]
        shift = spine_shifts(np.vstack([V, *beside]), np.vstack([F, *faces]), body.motion, _radius(body))
        np.testing.assert_allclose(shift[:, 0], 0.0, atol=1e-6)


def test_in_a_trunk_that_leans_sideways_aside_is_across_it(person):
    """A joint never goes along the line through its neighbours, also where arms lean with the trunk and hips do not."""
    body = _upright(person)
    rest, Q = body.motion.rest.copy(), _about_y(25.0)
    joints = [j for j in range(len(body.names)) if j not in _legs(body)]
    pelvis = rest[joints[0]].copy()
    rest[joints] = (rest[joints] - pelvis) @ Q.T + pelvis
    V, F = _trunk(breadth=220.0, aside=30.0)
    shift = spine_shifts((V - pelvis) @ Q.T + pelvis, F, body.motion._replace(rest=rest), _radius(body))
    spine, *shoulders = (rest[body.names.index(name)] for name in ("spine", "shoulder_l", "shoulder_r"))
    moved = shift[body.names.index("chest")]
    assert abs(moved @ Q[:, 0]) > 5.0
    np.testing.assert_allclose(moved @ (np.mean(shoulders, axis=0) - spine), 0.0, atol=1e-6)


def test_a_joint_outside_of_the_body_goes_back_by_its_radius(person):
    body = _upright(person)
    for middle in (-200.0, 200.0):
        shift = spine_shifts(*_trunk(middle=middle), body.motion, _radius(body))
        np.testing.assert_allclose(shift, spine_shifts(*NOWHERE, body.motion, _radius(body)))


def test_it_goes_with_the_body_into_other_coordinates(person):
    Q = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    V, F = _trunk(middle=10.0, breadth=220.0, aside=25.0)
    here = spine_shifts(V, F, person.motion, _radius(person))
    there = spine_shifts(0.01 * V @ Q.T, F, turned(person.motion, Q, 0.01), 0.01 * _radius(person))
    np.testing.assert_allclose(there, 0.01 * here @ Q.T, atol=1e-9)
    assert not np.allclose(here, spine_shifts(*NOWHERE, person.motion, _radius(person))), "the surface counts"


def test_in_a_bent_trunk_every_joint_goes_back_where_it_is(person):
    motion, chest = person.motion, person.names.index("chest")
    above = [j for j in range(len(person.names)) if _is_beyond(motion.parents, j, chest)]
    rest, X = motion.rest.copy(), motion.X.copy()
    for points in (rest, *X):
        points[above] = (points[above] - points[chest]) @ _about_x(40.0).T + points[chest]
    shift = spine_shifts(*NOWHERE, motion._replace(rest=rest, X=X), _radius(person))
    low, high = shift[person.names.index("spine")], shift[chest]
    assert high[2] > low[2] + 3.0, "a chest that leans forwards goes back and up"


def test_an_animal_and_a_person_whose_front_is_unknown_keep_their_spines(person):
    dog = walker("quadruped")
    assert not spine_shifts(*NOWHERE, dog.motion, _radius(dog)).any()
    assert not spine_shifts(*NOWHERE, person.motion, _radius(person), SpineJointsSettings(certainty=1.1)).any()


@pytest.mark.parametrize(
    ("parents", "legs", "arms", "expected"),
    [
        ((-1, 0, 1, 2, 2, 0, 0), (5, 6, 0), (3, 4, 2), [1, 2]),  # the root in the pelvis
        ((-1, 0, 1, 0, 0, 2, 2), (5, 6, 2), (3, 4, 0), [2, 1]),  # in the chest
        ((-1, 0, 0, 1, 1, 2, 2), (3, 4, 1), (5, 6, 2), [1, 2]),  # between both
        ((-1, 0, 0, 0, 0), (1, 2, 0), (3, 4, 0), []),  # all limbs on one part
        ((-1, 0, 1, 2, 3, 3, 1, 1), (6, 7, 1), (4, 5, 3), [2, 3]),  # in the tail, whose joint is none of the spine
    ],
)
def test_the_spine_lies_between_legs_and_arms_wherever_the_root_is(parents, legs, arms, expected):
    pairs = [(Limb((a,), base, 1.0), Limb((b,), base, 1.0)) for a, b, base in (legs, arms)]
    assert spine(np.array(parents), *pairs) == expected


def test_where_one_arm_hangs_lower_the_spine_ends_there():
    parents = np.array([-1, 0, 1, 1, 2, 0, 0])
    legs, arms = (Limb((5,), 0, 1.0), Limb((6,), 0, 1.0)), (Limb((4,), 2, 1.0), Limb((3,), 1, 1.0))
    assert spine(parents, legs, arms) == [1]


def _is_beyond(parents: np.ndarray, joint: int, other: int) -> bool:
    """Whether a joint lies below another one."""
    while joint >= 0:
        joint = int(parents[joint])
        if joint == other:
            return True
    return False


def _about_x(degrees: float) -> np.ndarray:
    """The rotation about x by which a body that faces −y leans forwards."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def _about_y(degrees: float) -> np.ndarray:
    """The rotation about y by which a body that faces −y leans to a side."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def _legs(body: Walker) -> set[int]:
    """Joints of both legs."""
    hips = [body.names.index(f"hip_{side}") for side in "lr"]
    return {j for j in range(len(body.names)) for hip in hips if j == hip or _is_beyond(body.motion.parents, j, hip)}
