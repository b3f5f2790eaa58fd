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


def _both_ways(tree: KinematicTree, joint: int, way: np.ndarray) -> tuple[float, float]:
    """How far the surface is from a joint in a direction (xyz,) and in the opposite one."""
    surface = trimesh.Trimesh(np.array(tree.vertices), np.array(tree.faces), process=False)
    normal = np.cross(way, (0.0, 0.0, 1.0))
    section = trimesh.intersections.mesh_plane(surface, normal, tree.rest[joint]) - tree.rest[joint]
    height, along = section @ np.cross(normal, way), section @ way
    crosses = height[:, 0] * height[:, 1] <= 0.0
    share = height[crosses, 0] / (height[crosses, 0] - height[crosses, 1])
    at = along[crosses, 0] + share * (along[crosses, 1] - along[crosses, 0])
    return float(at[at > 0.0].min()), float(-at[at < 0.0].max())


def _expected_way(tree: KinematicTree, joint: int, back: np.ndarray) -> np.ndarray:
    """(xyz,) back by the mean way to a quarter of the radius behind the joint and to a third of the depth, and half of the way
    to the middle from side to side; `back` (xyz,) is the direction.
    """
    aside, radius = np.cross(back, (0.0, 0.0, 1.0)), tree.border_radius[joint]
    aside /= np.linalg.norm(aside)
    behind, before = _both_ways(tree, joint, back)
    assert radius < behind + before < 2.5 * radius, "the depth counts"
    to_third = behind - (behind + before) / 3.0
    left, right = _both_ways(tree, joint, aside)
    return (0.25 * radius + to_third) / 2.0 * back + (left - right) / 4.0 * aside


def _about_z(way: np.ndarray, degrees: float) -> np.ndarray:
    """A direction turned about the vertical."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([c * way[0] - s * way[1], s * way[0] + c * way[1], way[2]])


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
    for joint, direction in zip(moved, back, strict=True):
        # which way the trunk faces is known to some degrees; only one of them explains both parts of the way
        tried = [_expected_way(before, joint, _about_z(direction, turn)) for turn in np.arange(-15.0, 15.0, 0.25)]
        off = min(np.linalg.norm(way[joint] - one) for one in tried)
        assert off < 5e-3 * np.linalg.norm(way[joint])
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
