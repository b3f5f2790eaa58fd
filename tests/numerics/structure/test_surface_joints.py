"""Joints within limbs go where the frames' surfaces have them, and stay where these do not agree."""

from collections.abc import Callable

import numpy as np
import pytest
from articulated import chain
from shipped import TREE
from smeared import END, Frames, moving, turning

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.surface_joints import SurfaceJointsSettings, surface_joints, within_limbs
from kinetree.tasks.numerics.structure.tree_joints import Cut, TreeJoints, tree_joints

OFF = np.array([0.0, 0.0, 0.5])
"""How far off the joint is put, half a radius along the limb."""


def found_in(frames: int = 24, scale: float = 1.0) -> tuple[MovingSurface, TreeJoints]:
    """A tube of three parts in as many frames, aligned as it is."""
    body = chain((0.0, END), turning()[:frames], along=60)
    surface = moving(body)._replace(V=scale * body.V, x=scale * body.x, area=scale**2 * body.area)
    cut = Cut(surface.V, body.label, body.R, scale * body.t, body.residual)
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    return surface, tree_joints(surface, cut, tips, np.ones(body.x.shape[:2]), settings=TREE)


def moved(
    off: Floats = OFF, frames: int = 24, scale: float = 1.0, seen: float = 1.0,
    shown: Callable[[int], tuple[Floats, Ints]] | None = None, settings: SurfaceJointsSettings | None = None,
) -> tuple[Floats, Floats]:  # fmt: skip
    """The joints as they were put and as they come back; the last one is put off."""
    surface, found = found_in(frames, scale)
    rest = found.rest.copy()
    rest[1:, :2], rest[1, 2], rest[2] = 0.0, 0.0, scale * (np.array([0.0, 0.0, END]) + off)
    given = shown or Frames(turning(), 0.02, scale)
    return rest, surface_joints(surface, found, rest, np.full(surface.x.shape[:2], seen), given, settings)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_joint_that_lies_off_along_its_limb_comes_back(way: float) -> None:
    _, after = moved(way * OFF)
    assert abs(after[2, 2] - END) < 0.4 * OFF[2]
    np.testing.assert_allclose(after[2, :2], 0.0, atol=0.1)


def test_a_joint_that_lies_right_stays_there() -> None:
    _, after = moved(0.0 * OFF)
    np.testing.assert_allclose(after[2], [0.0, 0.0, END], atol=0.1)


def test_the_same_on_a_body_of_another_size() -> None:
    (_, one), (_, two) = moved(), moved(scale=40.0)
    np.testing.assert_allclose(40.0 * one, two, atol=0.4)
    assert abs(two[2, 2] - 40.0 * END) < 0.4 * 40.0 * OFF[2]


def test_joints_of_limbs_with_the_trunk_stay() -> None:
    before, after = moved()
    np.testing.assert_array_equal(before[:2], after[:2])
    assert within_limbs(np.array([-1, 0, 1, 2, 0, 4, 4])).tolist() == [False, False, True, True, False, False, False]


@pytest.mark.parametrize("period", [1, 6], ids=["each second frame", "each second quarter"])
def test_a_joint_stays_where_halves_of_the_frames_put_it_at_different_places(period: int) -> None:
    low, high = (chain((0.0, END + d), turning(), around=27, along=83) for d in (-0.8, 0.3))

    def shown(frame: int) -> tuple[Floats, Ints]:
        body = low if frame // period % 2 else high
        return body.x[frame], body.F

    before, after = moved(shown=shown)
    np.testing.assert_array_equal(before, after)
    assert moved(shown=shown, settings=SurfaceJointsSettings(agree=1e9))[1][2, 2] != before[2, 2]


def test_few_frames_move_no_joint() -> None:
    before, after = moved(frames=7)
    np.testing.assert_array_equal(before, after)
    assert (moved(frames=8, settings=SurfaceJointsSettings(agree=1e9))[1] != before).any()


def test_frames_that_do_not_show_the_parts_hardly_move_a_joint() -> None:
    before, after = moved(seen=0.0)
    assert np.linalg.norm(after[2] - before[2]) < 0.2 * OFF[2]


def test_of_many_frames_some_are_looked_at() -> None:
    asked = []

    def shown(frame: int) -> tuple[Floats, Ints]:
        asked.append(frame)
        return Frames(turning(), 0.02)(frame)

    _, after = moved(shown=shown, settings=SurfaceJointsSettings(most_frames=12))
    assert len(asked) == 12
    assert (asked[0], asked[-1]) == (0, 23)
    assert abs(after[2, 2] - END) < 0.5 * OFF[2]
