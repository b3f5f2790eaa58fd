"""The spine of a generated person, with and without the setting, from files to the articulated body."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.structure.kinematic_tree import KinematicTree

SMALL: dict[str, Any] = {
    "geodesics": {"bases": 40},
    "deformation_graph": {"nodes": 120},
    "rigid_parts": {"patches": 100},
    "compute": {"executor": "sync"},
}


def _trees(output: Path, connectivity: str) -> tuple[KinematicTree, KinematicTree]:
    """The articulated body without the setting, and with it; the person faces −y."""
    who = {"figure": "adult:9", "motion": "dance", "fps": 10}
    synth = {**who, "frames": 8, "vertices": 1200, "connectivity": connectivity}
    trees = []
    for spine in (False, True):
        told = {"output": str(output), **SMALL, "source": {"synth": synth}, "kinematic_tree": {"spine": spine}}
        pipeline = Pipeline.of(told)
        assert pipeline.run(until=["kinematic_tree"])["status"] == "done"
        trees.append(pipeline.artifact(KinematicTree))
    return trees[0], trees[1]


def _way_back(tree: KinematicTree, joints: np.ndarray, back: np.ndarray) -> np.ndarray:
    """(joint,) the mean way to a quarter of the radius behind the joint and to a third of the depth; `back` (joint, xyz)."""
    surface = trimesh.Trimesh(np.array(tree.vertices), np.array(tree.faces), process=False)
    to_third, depths = [], []
    for joint, way in zip(tree.rest[joints], back, strict=True):
        normal = np.cross(way, (0.0, 0.0, 1.0))
        section = trimesh.intersections.mesh_plane(surface, normal, joint) - joint
        height, along = section @ np.cross(normal, way), section @ way
        crosses = height[:, 0] * height[:, 1] <= 0.0
        share = height[crosses, 0] / (height[crosses, 0] - height[crosses, 1])
        at = along[crosses, 0] + share * (along[crosses, 1] - along[crosses, 0])
        behind, before = at[at > 0.0].min(), -at[at < 0.0].max()
        to_third.append(behind - (behind + before) / 3.0)
        depths.append(behind + before)
    radius = tree.border_radius[joints]
    assert (np.array(depths) > radius).all(), "the depth counts"
    assert (np.array(depths) < 2.5 * radius).all()
    return (0.25 * radius + np.array(to_third)) / 2.0


@pytest.fixture(scope="module")
def trees(tmp_path_factory: pytest.TempPathFactory) -> tuple[KinematicTree, KinematicTree]:
    return _trees(tmp_path_factory.mktemp("new"), "new")


def test_joints_of_the_spine_go_back_and_no_other_joint_moves(trees: tuple[KinematicTree, KinematicTree]) -> None:
    before, after = trees
    assert after.names == before.names
    way = after.rest - before.rest
    moved = np.flatnonzero(np.linalg.norm(way, axis=1) > 0.0)
    assert len(moved)
    assert {after.names[j].split("_")[0] for j in moved} == {"spine"}
    back = way[moved] / np.linalg.norm(way[moved], axis=1)[:, None]
    assert (back[:, 1] > 0.8).all()
    expected = _way_back(before, moved, back)[:, None] * back
    np.testing.assert_allclose(way[moved], expected, rtol=2e-3, err_msg="these lie nearly amid both sides already")
    stays = np.setdiff1d(np.arange(len(way)), moved)
    np.testing.assert_allclose(after.drift[stays], before.drift[stays])
    assert not np.isclose(after.drift[moved], before.drift[moved]).any(), "drift is that of where a joint lies"


def test_bones_keep_their_lengths_about_the_moved_joints(trees: tuple[KinematicTree, KinematicTree]) -> None:
    _, after = trees
    above = np.array(after.parents[1:])
    length = np.linalg.norm(after.positions[:, 1:] - after.positions[:, above], axis=2)
    at_rest = np.linalg.norm(after.rest[1:] - after.rest[above], axis=1)
    np.testing.assert_allclose(length, np.broadcast_to(at_rest, length.shape))


def test_limbs_stay_on_the_surface_though_the_spine_moves(trees: tuple[KinematicTree, KinematicTree]) -> None:
    before, after = trees
    limbs = [j for j, name in enumerate(after.names) if name.startswith("limb")]
    step = np.linalg.norm(after.positions[:, limbs] - before.positions[:, limbs], axis=2)
    assert step.mean() < 0.25 * np.linalg.norm(after.rest - before.rest, axis=1).max(), "frames are posed anew"


def test_where_the_frames_give_every_vertex_the_spine_stays(tmp_path: Path) -> None:
    before, after = _trees(tmp_path, "fixed")
    assert after.positions.tobytes() == before.positions.tobytes()
