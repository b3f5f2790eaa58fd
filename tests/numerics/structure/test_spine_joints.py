"""Laws of the places of a person's spine."""

import numpy as np
import pytest
from walkers import Walker, turned, walker

from kinetree.tasks.numerics.structure.limbs import Limb
from kinetree.tasks.numerics.structure.spine_joints import SpineJointsSettings, spine, spine_shifts


@pytest.fixture(scope="module")
def person() -> Walker:
    return walker("human")


def _radius(body: Walker) -> np.ndarray:
    return np.where(body.ends, 0.0, 100.0)


def test_the_spine_of_a_person_goes_back_by_its_share_of_the_radius_and_nothing_else_moves(person):
    shift = spine_shifts(person.motion, _radius(person))
    spine_of = [person.names.index(name) for name in ("spine", "chest")]
    np.testing.assert_allclose(np.linalg.norm(shift[spine_of], axis=1), 100.0 * SpineJointsSettings().behind)
    assert (shift[spine_of, 1] > 0.95 * 25.0).all(), "it faces −y"
    assert not np.delete(shift, spine_of, axis=0).any()


def test_it_goes_with_the_body_into_other_coordinates(person):
    Q = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    there = spine_shifts(turned(person.motion, Q, 0.01), 0.01 * _radius(person))
    np.testing.assert_allclose(there, 0.01 * spine_shifts(person.motion, _radius(person)) @ Q.T, atol=1e-9)


def test_in_a_bent_trunk_every_joint_goes_back_where_it_is(person):
    motion, chest = person.motion, person.names.index("chest")
    above = [j for j in range(len(person.names)) if _is_beyond(motion.parents, j, chest)]
    rest, X = motion.rest.copy(), motion.X.copy()
    for points in (rest, *X):
        points[above] = (points[above] - points[chest]) @ _about_x(40.0).T + points[chest]
    shift = spine_shifts(motion._replace(rest=rest, X=X), _radius(person))
    low, high = shift[person.names.index("spine")], shift[chest]
    assert high[2] > low[2] + 3.0, "a chest that leans forwards goes back and up"


def test_an_animal_and_a_person_whose_front_is_unknown_keep_their_spines(person):
    dog = walker("quadruped")
    assert not spine_shifts(dog.motion, _radius(dog)).any()
    assert not spine_shifts(person.motion, _radius(person), SpineJointsSettings(certainty=1.1)).any()


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
