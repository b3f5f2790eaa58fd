"""A long part's centre line says where its joints are expected."""

import numpy as np
import numpy.typing as npt
import pytest
from limbs import rotation, tube

from kinetree.tasks.numerics.structure.centre_lines import ExpectedJoints, about_lines, centre_line, towards_centre_lines

EXPECTED = np.array([[0.3, 0.2, -4.0], [-0.2, 0.3, 4.0]])


def body(stretch: float = 1.0) -> npt.NDArray[np.float64]:
    """A tube of radius 1 about z, from −6 to 6 times `stretch`."""
    V, _ = tube(around=24, along=120, flat=1.0)
    V = V - V.mean(axis=0)
    return np.asarray(V * [1.0, 1.0, 12.0 * stretch / np.ptp(V[:, 2])])


def found(parents: list[int], *, radius: float = 1.0, stretch: float = 1.0, bow: float = 0.0) -> ExpectedJoints:
    """Where joints are expected of three parts of a tube, that were seen to one side of it; `bow` bends the middle one."""
    V = body(stretch)
    label = np.where(V[:, 2] < -4 * stretch, 0, np.where(V[:, 2] < 4 * stretch, 1, 2))
    V[:, 0] += bow * np.cos(V[:, 2] * np.pi / (4 * stretch))
    at = EXPECTED * [1.0, 1.0, stretch]
    return towards_centre_lines(V, np.ones(len(V)), label, np.eye(3)[label], np.array(parents), at, np.full(2, radius))


def expected(parents: list[int], *, radius: float = 1.0, stretch: float = 1.0, bow: float = 0.0) -> npt.NDArray[np.float64]:
    """The places alone."""
    return found(parents, radius=radius, stretch=stretch, bow=bow).place


def test_joints_at_both_ends_of_a_long_part_are_expected_on_its_line() -> None:
    assert expected([-1, 0, 1]) == pytest.approx(EXPECTED * [0.0, 0.0, 1.0], abs=0.02)


def test_lines_lead_along_the_part_and_count_as_much_as_the_places_follow_them() -> None:
    np.testing.assert_allclose(found([-1, 0, 1]).lines, np.tile(np.diag([0.0, 0.0, 1.0]), (2, 1, 1)), atol=0.02)
    off = np.linalg.norm(EXPECTED[:, :2], axis=1)
    part = found([-1, 0, 1], radius=float(off.mean()) / 1.4)
    way = 1.0 - np.linalg.norm(part.place[:, :2], axis=1) / off
    assert ((way > 0.2) & (way < 0.8)).all()
    np.testing.assert_allclose(np.trace(part.lines, axis1=1, axis2=2), way, atol=0.05)
    assert not found([-1, 0, 0]).lines.any()


def test_a_stiffness_about_lines_is_as_firm_as_asked_in_every_direction() -> None:
    z = np.diag([0.0, 0.0, 1.0])
    np.testing.assert_allclose(about_lines(np.stack([z, 0.5 * z, 0.0 * z]), 4.0, 9.0, 1.0), [
        np.diag([9.0, 9.0, 1.0]), np.diag([6.5, 6.5, 2.5]), np.diag([4.0, 4.0, 4.0]),
    ])  # fmt: skip
    Q = rotation((1.0, 2.0, 0.5), 1.1)
    turned = Q @ np.diag([9.0, 9.0, 1.0]) @ Q.T
    np.testing.assert_allclose(about_lines(Q @ z @ Q.T, 4.0, 9.0, 1.0), turned, atol=1e-12)


def elbow(degrees: float) -> ExpectedJoints:
    """Three long parts of a tube, the middle one bent against both others by so much."""
    V = body(2.0)
    label = np.where(V[:, 2] < -4.0, 0, np.where(V[:, 2] < 4.0, 1, 2))
    ends = np.array([[0.0, 0.0, -4.0], [0.0, 0.0, 4.0]])
    Q = rotation((1.0, 0.0, 0.0), np.radians(degrees))
    for part, end in ((0, ends[0]), (2, ends[1])):
        V[label == part] = (V[label == part] - end) @ Q.T + end
    at = ends + [0.3, 0.0, 0.0]
    W = np.eye(4)[np.where(label == 2, 2, label)]
    parents, label = np.array([-1, 0, 1, 2]), np.where((label == 2) & (V[:, 2] > 11.0), 3, label)
    return towards_centre_lines(V, np.ones(len(V)), label, W, parents, np.vstack([at, at[1:]]), np.ones(3))


def test_of_two_lines_each_counts_a_half() -> None:
    found = elbow(20.0)
    a, b = np.array([0.0, 0.0, 1.0]), rotation((1.0, 0.0, 0.0), np.radians(20.0))[:, 2]
    for joint in (0, 1):
        np.testing.assert_allclose(np.trace(found.lines[joint]), 1.0)
        np.testing.assert_allclose(found.lines[joint], (np.outer(a, a) + np.outer(b, b)) / 2.0, atol=0.03)
        assert abs(found.place[joint, 0]) < 0.03, "and neither the way to one twice"


@pytest.mark.parametrize(("radii", "counts"), [(1.15, 1.0), (1.4, 0.5), (1.65, 0.0)])
def test_a_line_counts_less_the_farther_it_passes_the_border(radii: float, counts: float) -> None:
    off = np.linalg.norm(EXPECTED[0, :2])
    np.testing.assert_allclose(np.trace(found([-1, 0, 1], radius=float(off) / radii).lines[0]), counts, atol=0.08)


def test_a_part_on_which_nothing_or_much_hangs_says_nothing() -> None:
    assert expected([-1, 0, 0]) == pytest.approx(EXPECTED)


def test_a_short_or_bent_part_and_a_line_far_from_the_border_say_nothing() -> None:
    assert expected([-1, 0, 1], stretch=0.15) == pytest.approx(EXPECTED * [1.0, 1.0, 0.15])
    assert expected([-1, 0, 1], bow=0.5) == pytest.approx(EXPECTED)
    assert expected([-1, 0, 1], radius=0.2) == pytest.approx(EXPECTED)


def test_an_oblique_cut_tilts_the_principal_axis_but_not_the_line() -> None:
    V = body()
    V = V[V[:, 2] < 2.0 + 2.5 * V[:, 0]]
    line = centre_line(V, np.ones(len(V)))
    assert line is not None
    tilted = np.linalg.eigh(np.cov(V.T))[1][:, 2]
    assert abs(tilted[0]) > 0.05
    assert abs(line.axis[0]) < 0.03


def test_the_line_is_that_of_the_middle_wherever_the_surface_is_sampled_densely() -> None:
    V = body()
    dense = np.concatenate([V, np.repeat(V[V[:, 0] > 0.3], 5, axis=0)])
    line = centre_line(dense, np.ones(len(dense)))
    assert line is not None
    assert np.hypot(*line.point[:2]) < 0.1
    assert np.hypot(*dense.mean(axis=0)[:2]) > 0.3


def test_the_line_moves_with_the_part() -> None:
    V, Q, shift = body() + [0.1, 0.0, 0.3], rotation((1.0, 2.0, 0.5), 1.1), np.array([3.0, -7.0, 2.0])
    here, there = centre_line(V, np.ones(len(V))), centre_line(V @ Q.T + shift, np.ones(len(V)))
    assert here is not None
    assert there is not None
    assert abs(there.axis @ (Q @ here.axis)) == pytest.approx(1.0, abs=1e-4)
    off = there.point - (Q @ here.point + shift)
    assert np.linalg.norm(off - there.axis * (off @ there.axis)) < 0.01


def test_what_has_no_whole_sections_has_no_line() -> None:
    V = body()
    half = V[V[:, 0] > 0.0]
    assert centre_line(half, np.ones(len(half))) is None
    assert centre_line(V, np.zeros(len(V))) is None
