"""Joints go where the frames' surfaces have them, and stay where these do not agree."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from articulated import chain
from smeared import END, Frames, three_parts, turning

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.first_tree import in_tree_order
from kinetree.tasks.numerics.structure.laid_parts import laid_parts
from kinetree.tasks.numerics.structure.surface_joints import (
    SurfaceJoints,
    SurfaceJointsSettings,
    _Pull,
    _shortened_shift,
    surface_joints,
    within_limbs,
)

OFF = np.array([0.0, 0.0, 0.5])
"""How far off the joint is put, half a radius along the limb."""
HERE = np.zeros(3)
"""No shift of the body from where it lies."""
STAY = SurfaceJointsSettings(agree=0.0, hold=1e9)
"""No joint goes to where its two parts turn."""


def on_surfaces(
    off: Floats = OFF, frames: int = 24, scale: float = 1.0, seen: float | Floats = 1.0,
    mesh_at: Callable[[int], tuple[Floats, Ints]] | None = None, settings: SurfaceJointsSettings | None = None,
    shift: Floats = HERE, hinged: bool = True, held: Flags | None = None, trunk_off: Floats = HERE,
    shown: tuple[int, ...] = (), lines: Floats | None = None,
) -> tuple[Floats, SurfaceJoints]:  # fmt: skip
    """The joints as they were put, and what the surfaces say of them; the last one is put off, and that of the limb with the
    trunk too, and the body is shifted.
    """
    surface, found = three_parts(frames, scale)
    rest = found.rest.copy()
    rest[1], rest[2] = scale * trunk_off, scale * (np.array([0.0, 0.0, END]) + off)
    meshes, size = mesh_at or Frames(turning(), 0.02, scale), surface.size
    tree = in_tree_order(found, 3)
    tree, rest = tree._replace(t=tree.t + shift - tree.R @ shift, rest=tree.rest + shift, shown=shown), rest + shift
    surfaces = {f: Target.of(V + shift, F, size) for f, (V, F) in ((f, meshes(f)) for f in range(frames))}
    laid = laid_parts(surface.V + shift, surface.F, surface.area, tree, surfaces)
    if not hinged:
        laid = laid._replace(hinges=laid.hinges._replace(joint=laid.hinges.joint[:0], end=laid.hinges.end[:0]))
    return rest, surface_joints(tree, laid, rest, np.broadcast_to(seen, (frames, 3)), settings, held, lines=lines)


def moved(*args: Any, **kwargs: Any) -> tuple[Floats, Floats]:
    """The joints as they were put and as they come back."""
    before, found = on_surfaces(*args, **kwargs)
    return before, found.rest


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_joint_that_lies_off_along_its_limb_comes_back(way: float) -> None:
    _, after = moved(way * OFF)
    assert abs(after[2, 2] - END) < 0.4 * OFF[2]
    np.testing.assert_allclose(after[2, :2], 0.0, atol=0.1)


def test_a_joint_that_lies_right_stays_there() -> None:
    _, after = moved(0.0 * OFF)
    np.testing.assert_allclose(after[2], [0.0, 0.0, END], atol=0.1)


def test_a_joint_that_is_held_stays_and_knows_how_far_off_the_surfaces_have_it() -> None:
    before, found = on_surfaces(held=np.array([False, False, True]))
    np.testing.assert_array_equal(found.rest[2], before[2])
    assert found.offset[2] > 0.3


def test_the_same_on_a_body_of_another_size() -> None:
    (_, one), (_, two) = moved(), moved(scale=40.0)
    np.testing.assert_allclose(40.0 * one, two, atol=0.4)
    assert abs(two[2, 2] - 40.0 * END) < 0.4 * 40.0 * OFF[2]


@pytest.mark.parametrize("lengths", [10.0, 1000.0])
def test_the_same_far_from_the_origin(lengths: float) -> None:
    shift = 10.0 * lengths * np.array([0.6, -0.64, 0.48])
    (_, here), (_, there) = on_surfaces(), on_surfaces(shift=shift)
    np.testing.assert_allclose(there.rest - shift, here.rest, atol=1e-3)
    np.testing.assert_allclose(there.offset, here.offset, atol=1e-3)


def test_a_body_in_metres_lies_as_well_a_thousand_kilometres_away() -> None:
    size, shift = 0.1, 1e6 * np.array([0.6, -0.64, 0.48])
    (_, here), (_, there) = on_surfaces(scale=size), on_surfaces(scale=size, shift=shift)
    np.testing.assert_allclose(there.rest - shift, here.rest, atol=1e-5 * size)
    for name in ("offset", "hinge"):
        np.testing.assert_allclose(getattr(there, name), getattr(here, name), atol=1e-5 * size)


def test_a_joint_of_a_limb_with_the_trunk_stays_where_it_lies_right() -> None:
    before, after = moved()
    np.testing.assert_array_equal(before[0], after[0])
    np.testing.assert_allclose(before[1], after[1], atol=0.01)


@pytest.mark.parametrize("off", [(0.0, 0.0, 0.5), (0.0, 0.0, -0.5), (0.0, 0.5, 0.0)])
def test_a_joint_of_a_limb_with_the_trunk_that_lies_off_comes_back_by_half_or_more(off: tuple[float, ...]) -> None:
    _, after = moved(0.0 * OFF, trunk_off=np.array(off), hinged=False)
    assert np.linalg.norm(after[1]) < 0.25


def test_a_joint_stays_along_the_line_that_it_turns_about_where_only_noise_would_lead_it() -> None:
    line = np.array([0.5, 0.0, 0.0])
    _, after = moved(0.0 * OFF, trunk_off=line)
    np.testing.assert_allclose(after[1], line, atol=0.02)
    _, free = moved(0.0 * OFF, trunk_off=line, settings=SurfaceJointsSettings(hold=0.0))
    assert free[1, 0] < 0.2


def test_a_joint_that_agreement_or_a_hinge_moves_goes_no_further() -> None:
    for off, agree in ((OFF, 0.5), (OFF, 0.0)):
        (_, here), (_, held) = (
            moved(off, trunk_off=OFF, settings=SurfaceJointsSettings(agree=agree, hold=hold)) for hold in (0.3, 1e9)
        )
        np.testing.assert_allclose(here, held, atol=1e-6)


def test_joints_of_a_divided_trunk_come_back_too() -> None:
    _, after = moved(trunk_off=OFF, hinged=False, shown=(1,))
    assert np.linalg.norm(after[1]) < 0.25
    assert abs(after[2, 2] - END) < 0.25


def pull(at: Floats, firm: float = 1.0) -> _Pull:
    """Frames that turn half of the body about x, each about its own centre (frame, xyz)."""
    turn = np.tile(np.diag([0.0, 2.0, 2.0]), (len(at), 1, 1))
    return _Pull(turn, 2.0 * at, np.tile(firm * np.eye(3), (len(at), 1, 1)), np.ones(len(at)))


@pytest.mark.parametrize("firm", [1.0, 1e6])
@pytest.mark.parametrize("period", [1, 6], ids=["each second frame", "each second quarter"])
def test_the_way_is_shortened_by_what_halves_disagree(period: int, firm: float) -> None:
    """The centres of two halves lie at c ± a; by the other way to halve, both halves have c."""
    c, a = np.array([0.0, 0.5, 0.2]), np.array([0.0, 0.1, -0.05])
    side = np.where(np.arange(24) // period % 2 == 0, 1.0, -1.0)
    s, v = c / 1.3, (a @ a) / 1.3**2 / 2.0
    way = _shortened_shift(pull(c + side[:, None] * a, firm), 0.3 * np.eye(3), 10.0, SurfaceJointsSettings())
    np.testing.assert_allclose(way, s * (s @ s) / (s @ s + 6.0 * v), atol=0.01)


@pytest.mark.parametrize("way", [0.0, 0.4], ids=["across", "along"])
def test_a_joint_on_a_centre_line_goes_along_it_rather_than_across(way: float) -> None:
    off, lines = np.array([0.0, 0.4 - way, way]), np.zeros((3, 3, 3))
    lines[1] = np.diag([0.0, 0.0, 1.0])
    (_, free), (_, held) = (on_surfaces(0.0 * OFF, trunk_off=off, hinged=False, lines=to) for to in (None, lines))
    left, left_free = np.linalg.norm(held.rest[1]), np.linalg.norm(free.rest[1])
    assert left < 0.6 * left_free if way else left > 1.5 * left_free
    assert not np.allclose(held.rest[1], off, atol=0.02)


def test_a_joint_within_a_limb_on_a_centre_line_is_held_across_it() -> None:
    off, lines = np.array([0.0, 0.4, 0.0]), np.zeros((3, 3, 3))
    lines[2] = np.diag([0.0, 0.0, 1.0])
    (_, free), (_, held) = (on_surfaces(off, hinged=False, lines=to) for to in (None, lines))
    assert held.rest[2, 1] > 1.3 * free.rest[2, 1] > 0.0
    (_, free), (_, held) = (on_surfaces(OFF, hinged=False, lines=to) for to in (None, lines))
    np.testing.assert_allclose(held.rest[2, 2], free.rest[2, 2], atol=0.01, err_msg="and along it as before")


def test_the_way_is_half_a_radius_long_at_most() -> None:
    c = np.tile([0.0, 3.0, 4.0], (24, 1))
    way = _shortened_shift(pull(c), 0.3 * np.eye(3), 2.0, SurfaceJointsSettings())
    np.testing.assert_allclose(way, [0.0, 0.6, 0.8], atol=1e-9)


def test_parts_that_do_not_turn_move_no_joint() -> None:
    still = pull(np.zeros((24, 3)))._replace(M=np.zeros((24, 3, 3)))
    np.testing.assert_array_equal(_shortened_shift(still, 0.3 * np.eye(3), 1.0, SurfaceJointsSettings()), 0.0)


def test_a_joint_of_a_limb_with_the_trunk_stays_where_no_frame_shows_its_parts() -> None:
    before, after = moved(trunk_off=OFF, seen=0.0)
    np.testing.assert_array_equal(before[1], after[1])


@pytest.mark.parametrize("period", [1, 6], ids=["each second frame", "each second quarter"])
def test_a_joint_hardly_moves_where_halves_of_the_frames_put_it_at_different_places(period: int) -> None:
    low, high = (chain((0.0, END + d), turning(), around=27, along=83) for d in (-0.8, 0.3))

    def mesh_at(frame: int) -> tuple[Floats, Ints]:
        body = low if frame // period % 2 else high
        return body.x[frame], body.F

    before, after = moved(mesh_at=mesh_at)
    assert np.linalg.norm(after[2] - before[2]) < 0.06
    for sure in ({"agree": 1e9}, {"doubt": 0.0}):
        assert np.linalg.norm(moved(mesh_at=mesh_at, settings=SurfaceJointsSettings(**sure))[1][2] - before[2]) > 0.2


def test_frames_that_do_not_show_the_parts_hardly_move_a_joint() -> None:
    before, after = moved(seen=0.0)
    assert np.linalg.norm(after[2] - before[2]) < 0.2 * OFF[2]


@pytest.mark.parametrize("scale", [1.0, 40.0])
def test_a_joint_that_stays_off_is_as_far_from_its_place_on_the_surfaces_and_one_that_lies_right_is_near(scale: float) -> None:
    (_, off), (_, right) = (on_surfaces(share * OFF, scale=scale, settings=STAY, hinged=False) for share in (1.0, 0.0))
    assert 0.6 * OFF[2] < off.offset[2] / scale < 1.2 * OFF[2]
    assert right.offset[2] / scale < 0.1


def test_a_joint_that_is_moved_has_the_offset_that_is_left() -> None:
    before, found = on_surfaces()
    assert found.offset[2] < 0.5 * OFF[2] < np.linalg.norm(before[2] - found.rest[2]) + found.offset[2]


def test_a_joint_that_its_parts_leave_where_it_is_goes_along_its_limb_to_where_the_surfaces_bend() -> None:
    (before, alone), (_, hinged) = (on_surfaces(settings=STAY, hinged=hinged) for hinged in (False, True))
    np.testing.assert_allclose(alone.rest, before, atol=1e-6)
    np.testing.assert_allclose(hinged.rest[2], [0.0, 0.0, END], atol=0.1)


def test_a_joint_that_goes_along_its_limb_has_the_offset_of_where_it_goes() -> None:
    (before, alone), (_, hinged) = (on_surfaces(settings=STAY, hinged=hinged) for hinged in (False, True))
    assert np.linalg.norm(hinged.rest[2] - before[2]) > 0.5 * OFF[2]
    assert hinged.offset[2] < 0.5 * alone.offset[2]


def test_joints_that_may_not_move_have_an_offset_too_and_the_root_has_none() -> None:
    _, found = on_surfaces(held=np.array([False, True, True]))
    assert 0.0 < found.offset[1] < 0.2
    assert np.isnan(found.offset[0])


@pytest.mark.parametrize(("certain", "says"), [(0.0, False), (0.4, False), (0.6, True)])
def test_a_joint_whose_parts_few_frames_show_has_no_offset(certain: float, says: bool) -> None:
    _, found = on_surfaces(seen=certain)
    assert np.isfinite(found.offset[1:]).tolist() == [says, says]


def test_a_joint_has_an_offset_from_eight_frames_on_that_show_its_parts() -> None:
    shares = np.zeros((24, 3))
    shares[::3] = 1.0
    for count, says in ((8, True), (7, False)):
        shares[::3][count:] = 0.0
        _, found = on_surfaces(seen=shares)
        assert np.isfinite(found.offset[1:]).tolist() == [says, says]


def test_parts_within_limbs_are_those_without_a_branch_above_them() -> None:
    assert within_limbs(np.array([-1, 0, 1, 2, 0, 4, 4])).tolist() == [False, False, True, True, False, False, False]
