"""A joint near the end of a limb that the alignment does not show is found on the frames; none where nothing turns."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from limbs import rotation
from smeared import END, Frames, aligned, bent_by_flesh, found_in, turning
from whole_tree import joints_at_ends

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure import end_joints as module
from kinetree.tasks.numerics.structure.end_joints import (
    EndJoint,
    EndJointsSettings,
    _RingFits,
    _usual,
    judged_runs,
)
from kinetree.tasks.numerics.structure.evident_rings import EvidentRingsSettings
from kinetree.tasks.numerics.structure.first_tree import in_tree_order
from kinetree.tasks.numerics.structure.ring_evidence import RingEvidence


def joints_at(
    degrees: float | Floats,
    noise: float = 0.0,
    settings: EndJointsSettings | None = None,
    bent: float = 0.0,
    mirrored: tuple[int, ...] = (),
) -> list[EndJoint]:
    turn = turning(degrees) if isinstance(degrees, float) else degrees
    surface, tree = found_in(aligned(turn, bent))
    shown = Frames(turn, noise).prepared(surface.size)
    return joints_at_ends(surface, in_tree_order(tree, 2), np.ones(surface.x.shape[:2]), shown, settings, mirrored)


def to_and_fro(degrees: float, of_middle: float = 20.0) -> Floats:
    """Turns as in frames that are far apart: middle and end lie on the other side in every next one, the end twice running."""
    turn, frames = turning(0.0), np.arange(24)
    turn[:, 1] = [rotation((1.0, 0.0, 0.0), np.radians(of_middle) * (-1.0) ** f) for f in frames]
    turn[:, 2] = [rotation((1.0, 0.0, 0.0), np.radians(degrees) * (-1.0) ** (f // 2)) for f in frames]
    return turn


def found_in_takes(degrees: Sequence[float | Floats], noise: float) -> list[EndJoint]:
    """Takes of 24 frames, each with its own range of turning, or with these turns."""
    turn = np.concatenate([turning(one) if isinstance(one, float) else one for one in degrees])
    surface, tree = found_in(aligned(turn))
    takes = [slice(24 * k, 24 * k + 24) for k in range(len(degrees))]
    shown = Frames(turn, noise).prepared(surface.size)
    return joints_at_ends(surface._replace(takes=takes), in_tree_order(tree, 2), np.ones(surface.x.shape[:2]), shown)


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_joint_that_is_not_in_the_aligned_vertices_is_found(noise: float) -> None:
    (joint,) = joints_at(25.0, noise)
    np.testing.assert_allclose(joint.cut.centre, [0.0, 0.0, END], atol=0.4)
    assert joint.visible.all()


@pytest.mark.parametrize("mirrored", [(), (1,)])
def test_flesh_that_stays_behind_is_no_joint_of_a_limb_with_a_mirror_image(mirrored: tuple[int, ...]) -> None:
    assert len(joints_at(bent_by_flesh(4.0), 0.02, mirrored=mirrored)) == 1 - len(mirrored)
    assert len(joints_at(turning(4.0), 0.02, mirrored=mirrored)) == 1


def test_the_piece_beyond_moves_as_in_the_frames() -> None:
    (joint,) = joints_at(25.0)
    true = Frames(turning(25.0)).true
    between = np.einsum("tyx,tyz->txz", joint.R[:, 1], true.R[:, 2])
    # a round tube does not show how it turns about its own axis
    cosine = between[:, 2, 2]
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 6.0


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_where_frames_are_far_apart_both_halves_of_what_lies_beyond_show_the_joint(noise: float) -> None:
    (joint,) = joints_at(to_and_fro(15.0), noise)
    np.testing.assert_allclose(joint.cut.centre, [0.0, 0.0, END], atol=0.4)
    still = EvidentRingsSettings(nearer=60.0)
    for refused in ({"least_in_halves": 10.0}, {"halves_below": -2.0}, {"evident": still}):
        assert joints_at(to_and_fro(15.0), noise, EndJointsSettings(**refused)) == []


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_where_frames_are_far_apart_no_joint_is_found_where_nothing_turns(noise: float) -> None:
    assert joints_at(to_and_fro(0.0), noise) == []


def test_where_turns_go_on_halves_are_not_asked() -> None:
    turn = turning(0.0)
    turn[:, 2] = to_and_fro(15.0)[:, 2]
    assert joints_at(turn) == []


def test_where_frames_are_far_apart_a_turn_that_goes_on_is_found_too() -> None:
    turn = to_and_fro(0.0)
    turn[:, 2] = turning(25.0)[:, 2]
    assert len(joints_at(turn)) == 1


@pytest.mark.parametrize(
    ("goes_on", "lasting", "halves"), [(0.69, True, True), (0.71, True, False), (0.51, True, True), (0.49, False, True)]
)
def test_how_much_turns_go_on_says_what_is_asked(
    goes_on: float, lasting: bool, halves: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, set[bool]] = {"lasting": set(), "halves": set()}
    by_neighbours, by_halves = module.ring_evidence, module.evidence_of_halves

    def neighbours(*of: Any, lasting: bool) -> RingEvidence:
        asked["lasting"].add(lasting)
        return by_neighbours(*of, lasting=lasting)

    def in_halves(*of: Any) -> RingEvidence:
        asked["halves"].add(True)
        return by_halves(*of)

    monkeypatch.setattr(module, "going_on", lambda *of: goes_on)
    monkeypatch.setattr(module, "ring_evidence", neighbours)
    monkeypatch.setattr(module, "evidence_of_halves", in_halves)
    assert len(joints_at(25.0)) == 1
    assert asked == {"lasting": {lasting}, "halves": {True} if halves else set()}


def test_whether_frames_are_far_apart_is_judged_take_by_take() -> None:
    assert len(found_in_takes([0.0, 0.0, 0.0, to_and_fro(15.0, of_middle=6.0)], 0.0)) == 1


@pytest.mark.parametrize(("below", "joints"), [(0.9, 1), (1.1, 0)])
def test_scores_by_halves_count_by_their_own_limit(below: float, joints: int) -> None:
    (joint,), chosen = joints_at(to_and_fro(15.0)), EndJointsSettings()
    limit = joint.score * chosen.least_in_halves / chosen.evident.least_score
    assert len(joints_at(to_and_fro(15.0), settings=EndJointsSettings(least_in_halves=below * limit))) == joints


def test_halves_that_agree_more_never_lose_a_joint() -> None:
    turn = to_and_fro(0.0)
    turn[:, 2] = turning(25.0)[:, 2]
    strict = EvidentRingsSettings(slice_length=10.0, least_score_if_short=0.02)
    found = [joints_at(turn, settings=EndJointsSettings(strict, least_in_halves=limit)) for limit in (0.01, 0.04)]
    assert [len(joints) for joints in found] == [1, 1]


@pytest.mark.parametrize("noise", [0.0, 0.02, 0.05])
def test_no_joint_is_found_where_nothing_turns(noise: float) -> None:
    assert joints_at(0.0, noise) == []


@pytest.mark.parametrize(
    ("left", "kept"),
    [
        ((0.1, 0.1, 0.12, 0.19, 0.21, 0.4), (0, 1, 2, 3, 4)),
        ((0.1, 0.1, 0.1, 0.1, 0.25, 0.25), (0, 1, 2, 3)),
        ((0.0, 0.0, 0.0, 0.0, 0.09, 0.11), (0, 1, 2, 3, 4)),
        ((), ()),
    ],
)
def test_frames_in_which_something_touches_a_piece_do_not_count(left: tuple[float, ...], kept: tuple[int, ...]) -> None:
    """Distances from the surface with the hinge, of a ring of radius 1; with a twentieth of it or less nothing touches."""
    fits = {f: SimpleNamespace(two=two**2) for f, two in enumerate(left)}
    laid = _RingFits(SimpleNamespace(cut=SimpleNamespace(radius=1.0)), fits, {})  # type: ignore[arg-type]
    assert tuple(_usual(laid, EndJointsSettings()).fits) == kept


def test_where_no_frame_counts_no_joint_is_found() -> None:
    assert joints_at(25.0, 0.02, EndJointsSettings(most_left=0.0, little_left=0.0)) == []


def test_a_frame_in_which_little_is_seen_of_a_piece_loses_no_joint() -> None:
    """In a quarter of the frames the surface is another one; there the piece beyond goes with its part."""
    turn, touched = turning(25.0), range(9, 15)
    surface, tree = found_in(aligned(turn))
    free, touching = Frames(turn, 0.0).prepared(surface.size), Frames(turn, 0.3).prepared(surface.size)
    found = joints_at_ends(
        surface, in_tree_order(tree, 2), np.ones(surface.x.shape[:2]), lambda f: (touching if f in touched else free)(f)
    )
    assert len(found) == 1
    assert np.flatnonzero(~found[0].visible).tolist() == list(touched)


def test_a_reference_that_is_bent_beyond_the_ring_is_no_evidence() -> None:
    straight, bent = (joints_at(8.0, 0.03, bent=degrees)[0].score for degrees in (0.0, 15.0))
    assert 0.85 * straight < bent < 1.05 * straight
    assert joints_at(2.0, 0.06, bent=15.0) == []


@pytest.mark.parametrize(("degrees", "slice_length", "joints"), [(25.0, 1.0, 1), (25.0, 10.0, 0), (8.0, 10.0, 1)])
def test_a_short_piece_that_turns_less_than_what_is_beyond_is_a_slice_of_its_joint(
    degrees: float, slice_length: float, joints: int
) -> None:
    assert len(joints_at(degrees, settings=EndJointsSettings(EvidentRingsSettings(slice_length=slice_length)))) == joints


@pytest.mark.parametrize(("slice_length", "mirrored", "joints"), [(10.0, (1,), 0), (10.0, (0,), 1), (1.0, (1,), 1)])
def test_a_short_piece_of_a_limb_with_a_mirror_image_is_a_slice_however_it_turns(
    slice_length: float, mirrored: tuple[int, ...], joints: int
) -> None:
    settings = EndJointsSettings(EvidentRingsSettings(slice_length=0.0, slice_length_if_mirrored=slice_length))
    assert len(joints_at(8.0, settings=settings, mirrored=mirrored)) == joints


@pytest.mark.parametrize(("slice_length", "below", "joints"), [(10.0, 0.9, 1), (10.0, 1.1, 0), (1.0, 1.1, 1)])
def test_a_short_piece_must_show_more_clearly(slice_length: float, below: float, joints: int) -> None:
    (joint,) = joints_at(8.0, 0.03)
    settings = EndJointsSettings(EvidentRingsSettings(slice_length=slice_length, least_score_if_short=below * joint.score))
    assert len(joints_at(8.0, 0.03, settings)) == joints


def test_a_part_that_no_frame_shows_has_no_joint() -> None:
    surface, tree = found_in(aligned(turning()))
    confidence = np.where(surface.V[:, 2] > 0.0, 0.1, 1.0) * np.ones((len(surface.x), 1))
    assert joints_at_ends(surface, in_tree_order(tree, 2), confidence, Frames(turning()).prepared(surface.size)) == []


def test_in_frames_that_do_not_show_it_the_piece_goes_with_its_part() -> None:
    surface, tree = found_in(aligned(turning()))
    confidence = np.ones(surface.x.shape[:2])
    confidence[10:13, surface.V[:, 2] > 0.0] = 0.1
    (joint,) = joints_at_ends(surface, in_tree_order(tree, 2), confidence, Frames(turning()).prepared(surface.size))
    assert np.flatnonzero(~joint.visible).tolist() == [10, 11, 12]
    for piece in (0, 1):
        np.testing.assert_array_equal(joint.R[10:13, piece], tree.R[10:13, joint.cut.part])


def test_a_long_take_is_judged_in_some_frames_and_posed_in_all() -> None:
    (joint,) = joints_at(25.0, settings=EndJointsSettings(most_frames=12))
    assert joint.visible.all()


@pytest.mark.parametrize(("degrees", "noise"), [(4.0, 0.02), (6.0, 0.04)])
def test_a_joint_that_one_take_turns_counts_as_much_as_in_that_take_alone(degrees: float, noise: float) -> None:
    (alone,) = joints_at(degrees, noise)
    (joint,) = found_in_takes([degrees, 0.0, 0.0], noise)
    assert joint.score == pytest.approx(alone.score, rel=0.01)
    np.testing.assert_array_equal(joint.cut.far, alone.cut.far)
    assert len(joint.R) == 72


def test_the_part_must_turn_in_the_take_that_shows_the_joint() -> None:
    still = turning(6.0)
    still[:, 1] = np.eye(3)
    assert found_in_takes([0.0, still, 0.0], 0.02) == []
    assert len(found_in_takes([0.0, 6.0, 0.0], 0.02)) == 1


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_no_take_has_a_joint_where_none_turns(noise: float) -> None:
    assert found_in_takes([0.0, 0.0, 0.0], noise) == []


def test_frames_are_judged_in_runs_of_a_few_that_follow_each_other_within_a_take() -> None:
    runs = judged_runs(24, [slice(0, 12), slice(12, 24)])
    every = list(range(24))
    assert [run.tolist() for run in runs] == [every[a:b] for a, b in ((0, 5), (5, 10), (10, 12), (12, 17), (17, 22), (22, 24))]
    long = judged_runs(108, None)
    assert {len(run) for run in long} == {4}
    assert all((np.diff(run) == 1).all() for run in long)
    assert judged_runs(1, None) == []
