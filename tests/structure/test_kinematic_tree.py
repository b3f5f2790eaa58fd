"""The articulated body as the task gives it."""

import sys
from typing import Any

import numpy as np
import pytest
from aligned_body import FIRST, agreed, extended, rigid
from articulated import Known, chain, swings, three_arms
from pydantic import ValidationError
from smeared import END, Frames, aligned, turning

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.kinematic_tree import CutJointsParams, KinematicTree, KinematicTreeParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.structure import first_tree as numerics
from kinetree.tasks.numerics.structure.tree_joints import NOISE
from kinetree.tasks.structure.first_tree import first_tree
from kinetree.tasks.structure.further_cut import further_cut
from kinetree.tasks.structure.kinematic_tree import kinematic_tree
from kinetree.tasks.structure.laid_parts import laid_parts


def surface(V: np.ndarray, F: np.ndarray) -> Mesh:
    return Mesh(vertices=V, faces=F, vertex_of_input=np.arange(len(V)), cleaning=Cleaning())


def tree_of(
    body: Known,
    trust: np.ndarray | None = None,
    tips: tuple[int, ...] = (),
    surfaces: Frames | None = None,
    cut_frames: tuple[int, ...] = (),
    residual: float = 0.0,
    **params: float,
) -> KinematicTree:
    frames = tuple(range(FIRST, FIRST + len(body.x)))
    count = len(frames)
    reference = Reference(
        frames=frames, frame=FIRST + 2, vertices=body.V, faces=body.F,
        size=float(np.sqrt(body.area.sum())), fixed=True, leaves=len(tips), free=True,
        stems=np.zeros((0, 4, 3)), score=np.zeros(count),
    )  # fmt: skip
    parts = rigid(body, frames)
    zero, one = np.zeros(len(body.V)), np.ones(len(body.V))
    aligned = {
        f: Alignment(
            vertices=x, residual=zero + residual, stretch=one, confidence=one if trust is None else trust[k], uncovered=0.0
        )
        for k, (f, x) in enumerate(zip(frames, body.x, strict=True))
    }
    positions = np.broadcast_to(body.V[list(tips), None], (len(tips), count, 3))
    leaves = Leaves(
        frames=frames, rows=np.zeros((len(tips), count), int), positions=positions, kept=np.ones((1, len(tips)), bool),
        lost=np.zeros(0, int), lost_begin=np.zeros(0, int), lost_end=np.zeros(0, int),
    )  # fmt: skip
    mesh = {
        f: surface(*(surfaces(k) if surfaces else (x, body.F))) for k, (f, x) in enumerate(zip(frames, body.x, strict=True))
    }
    chosen = KinematicTreeParams(**params)
    poses = CutPoses(frames=cut_frames)
    cuts = {f: further_cut(poses, reference, aligned, leaves, CutJointsParams(), (f,)) for f in cut_frames}
    first = first_tree(reference, parts, aligned, mesh, leaves, chosen)
    agreeing = agreed(first, reference, aligned, mesh, leaves, cuts, chosen)
    tree = extended(agreeing, reference, aligned, mesh, leaves, chosen.surface_joints)
    runs = [tree.members("laid/frame", (k,)) for k in tree.members("laid", ())]
    laid = tuple(laid_parts(reference, tree, {f: mesh[f] for f in run}) for run in runs)
    return kinematic_tree(reference, tree, first, cuts, laid, aligned, leaves, UpDirection(up="z", confidence=1.0), chosen)


def test_arms_hang_on_one_root_and_end_in_their_leaves() -> None:
    body = three_arms()
    tips = tuple(int(np.argmax(body.V @ [np.cos(a), np.sin(a), 0.0])) for a in (0, 2 * np.pi / 3, 4 * np.pi / 3))
    found = tree_of(body, tips=tips)
    assert found.names == (
        "root", "limb_a_1", "limb_a_end", "limb_b_1", "limb_b_end", "limb_c_1", "limb_c_end"
    )  # fmt: skip
    assert found.parents == (-1, 0, 1, 0, 3, 0, 5)
    assert found.kinds == ("root", *("joint", "leaf") * 3)
    assert {tuple(p) for p in found.rest[[2, 4, 6]]} == {tuple(body.V[v]) for v in tips}
    assert found.frames[0] == FIRST
    assert found.lengths[[1, 3, 5]] == pytest.approx(12, abs=1.0)


def test_same_input_gives_the_same_bytes() -> None:
    one, two = tree_of(three_arms()), tree_of(three_arms())
    for name in KinematicTree.array_fields():
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()


def test_stiff_sequence_has_a_root_alone() -> None:
    found = tree_of(chain((0.0,), np.tile(np.eye(3), (12, 2, 1, 1))))
    assert found.kinds == ("root",)


def test_stiff_body_with_four_ends_has_a_root_and_ends_alone() -> None:
    body = chain((0.0,), np.tile(np.eye(3), (12, 2, 1, 1)))
    V = body.V
    tips = (int(V[:, 2].argmin()), int(V[:, 2].argmax()), int(V[:, 0].argmin()), int(V[:, 0].argmax()))
    assert set(tree_of(body, tips=tips).kinds[1:]) == {"leaf"}


def test_what_counts_as_a_joint_can_be_set() -> None:
    body = chain((0.0,), swings(16, 2, 10, axes=1))
    assert tree_of(body).kinds.count("joint") == 1
    assert tree_of(body, degrees=30.0).kinds.count("joint") == 0


def test_what_makes_a_joint_evident_reaches_the_evidence(monkeypatch: pytest.MonkeyPatch) -> None:
    body, asked = chain((0.0,), swings(16, 2)), []
    made = numerics.first_tree

    def listening(*given: Any, settings: Any) -> Any:
        asked.append(given[4].settings)
        return made(*given[:4], None, settings=settings)

    monkeypatch.setattr(numerics, "first_tree", listening)
    tree_of(body, np.full(body.x.shape[:2], 0.9), clear_motion=7.0, misfit_ratio=1.5, misfit_ratio_if_moving=1.2)
    assert [tuple(settings[:3]) for settings in asked] == [(7.0, 1.5, 1.2)]


@pytest.mark.parametrize("wrong", ["clear_motion", "misfit_ratio", "misfit_ratio_if_moving"])
def test_values_out_of_bounds_are_refused(wrong: str) -> None:
    with pytest.raises(ValidationError, match=wrong):
        KinematicTreeParams(**{wrong: -0.1})


def test_frame_that_is_not_trusted_has_a_pose_without_confidence() -> None:
    body = chain((0.0,), swings(16, 2))
    trust = np.ones(body.x.shape[:2])
    trust[5] = 0.0
    found = tree_of(body, trust)
    assert np.isfinite(found.positions).all()
    assert found.confidence[5].max() < 0.05 < 0.9 < found.confidence[6].min()
    assert found.support.tolist() == [15] * len(found.names)
    assert np.flatnonzero(found.uncertain).tolist() == [5]


def test_joints_at_ends_are_looked_for_where_connectivity_changes_and_only_if_asked() -> None:
    body, turn = aligned(turning()), turning()
    true = Frames(turn)
    confidence = np.full(body.x.shape[:2], 0.99)
    two = body._replace(label=(body.V[:, 2] > 0.0).astype(np.int64), R=body.R[:, :2], t=body.t[:, :2])
    asked, not_asked = (tree_of(two, confidence, surfaces=true, end_joints=flag) for flag in (True, False))
    assert asked.kinds.count("joint") == 2
    (end,) = asked.end_joints
    assert asked.rest[end, 2] == pytest.approx(END, abs=0.4)
    assert not_asked.end_joints == ()
    assert not_asked.kinds.count("joint") == 1


def test_joints_are_moved_on_the_surfaces_where_connectivity_changes_and_only_if_asked() -> None:
    body, true = chain((0.0, END + 0.5), turning(), along=60), Frames(turning(), 0.02)
    seen = np.full(body.x.shape[:2], 0.99)
    asked, not_asked = (tree_of(body, seen, surfaces=true, end_joints=False, surface_joints=flag) for flag in (True, False))
    assert asked.kinds == not_asked.kinds == ("root", "joint", "joint", "leaf")
    assert END - 0.1 < asked.rest[2, 2] < not_asked.rest[2, 2] - 0.2
    np.testing.assert_array_equal(asked.rest[[0, 3]], not_asked.rest[[0, 3]])
    edge = 10.0 / 83  # of the frames' surfaces, whose noise moves a joint that the vertices show where it is
    assert np.linalg.norm(not_asked.rest[1]) < 0.02 * edge
    assert np.linalg.norm(asked.rest[1]) < edge
    assert np.isfinite(asked.surface_offset).tolist() == [False, True, True, False]
    assert np.isnan(not_asked.surface_offset).all()
    given = [tree_of(body, surface_joints=flag) for flag in (True, False)]
    np.testing.assert_array_equal(*(found.rest for found in given))
    assert np.isnan(given[0].surface_offset).all()
    assert (given[0].is_given, asked.is_given) == (True, False)
    assert given[0].border_radius == pytest.approx([np.nan, 1.0, 1.0, np.nan], abs=0.05, nan_ok=True)


def test_part_that_hardly_turns_is_stored_as_dropped_and_has_no_joint() -> None:
    turn = swings(16, 2, degrees=30.0)
    turn[:, 1] = swings(16, 2, degrees=2.0)[:, 1]
    found = tree_of(chain((0.0,), turn))
    assert sorted(found.joint_of_part.tolist()) == [-1, 0]
    assert found.dropped == ((int(np.argmin(found.joint_of_part)), "still"),)
    assert found.in_tree.tolist() == [True]


def test_body_of_one_part_has_no_borders_and_no_bones() -> None:
    body = chain((0.0,), swings(12, 2))
    stiff = body._replace(label=np.zeros(len(body.V), int), R=body.R[:, :1], t=body.t[:, :1], x=np.stack([body.V] * 12))
    alone = tree_of(stiff)
    assert (len(alone.pair), alone.joint_of_part.tolist(), alone.free_length.tolist()) == (0, [0], [0.0])


def test_bones_of_rigid_arms_hardly_vary_before_their_lengths_are_held() -> None:
    found = tree_of(three_arms())
    assert sorted(found.joint_of_part.tolist()) == [0, 1, 3, 5]
    assert found.length_variation.max() < 0.5
    assert found.length_variation[0] == 0.0


def test_of_fixed_connectivity_the_cut_that_another_agrees_with_gives_the_tree() -> None:
    """The first cut lacks one of three arms."""
    body = three_arms()
    merged = body._replace(label=np.where(body.label == 3, 0, body.label), R=body.R[:, :3], t=body.t[:, :3])
    frames = (FIRST + 5, FIRST + 9)
    found = tree_of(merged, cut_frames=frames)
    assert (found.cut_frame, found.cuts, found.kinds.count("joint")) == (frames[0], 3, 3)
    assert len(found.part) == len(body.V)
    assert found.part.max() + 1 == len(found.joint_of_part) > 3
    joints = [j for j, kind in enumerate(found.kinds) if kind == "joint"]
    true = np.einsum("tpxy,py->tpx", body.R, body.joints)[:, 1:] + body.t[:, 1:]
    away = np.linalg.norm(found.positions[:, joints][:, :, None] - true[:, None], axis=3).mean(axis=0)
    assert away.min(axis=0).max() < 0.05 * np.ptp(body.V)
    followed = tree_of(merged, cut_frames=frames, residual=0.01 * float(np.ptp(body.V)))
    unsure = tree_of(merged, np.full(body.x.shape[:2], 0.9), cut_frames=frames, end_joints=False)
    for tree in (followed, unsure):
        assert (tree.cut_frame, tree.kinds.count("joint")) == (None, 2)


def test_joints_are_averaged_with_those_of_all_other_cuts_and_of_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of fixed connectivity another cut gives the tree; the first one's joints stand in its place."""
    body = three_arms()
    merged = body._replace(label=np.where(body.label == 3, 0, body.label), R=body.R[:, :3], t=body.t[:, :3])
    task, told = sys.modules["kinetree.tasks.structure.kinematic_tree"], []
    whole = task.numerics.kinematic_tree

    def listening(*of: Any, **named: Any) -> Any:
        told.append(named["further"])
        return whole(*of, **named)

    monkeypatch.setattr(task.numerics, "kinematic_tree", listening)
    found = tree_of(merged, cut_frames=(FIRST + 5, FIRST + 9))
    assert found.cut_frame == FIRST + 5
    assert [[joints.shape[1] for joints in further] for further in told] == [[2, 3]], "the first cut has two of three joints"


@pytest.mark.parametrize(("trust", "hidden_bones", "is_asked"), [(1.0, True, True), (1.0, False, False), (0.9, True, False)])
def test_links_are_looked_for_where_the_frames_give_every_vertex_and_hidden_bones_are_wanted(
    trust: float, hidden_bones: bool, is_asked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    body, asked = three_arms(), []

    def listening(_: Any, tree: Any, joints: Any, noise: float) -> Any:
        asked.append(noise)
        return tree, joints

    monkeypatch.setattr("kinetree.tasks.numerics.structure.kinematic_tree.with_rigid_links", listening)
    tree_of(body, np.full(body.x.shape[:2], trust), hidden_bones=hidden_bones, end_joints=False)
    assert asked == ([pytest.approx(NOISE * np.sqrt(body.area.sum()))] if is_asked else [])
