"""The wrists of a generated person who walks, with and without the setting, from files to the articulated body."""

from pathlib import Path
from typing import Any

import numpy as np

from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.structure.kinematic_tree import KinematicTree

SMALL: dict[str, Any] = {
    "geodesics": {"bases": 40},
    "deformation_graph": {"nodes": 120},
    "rigid_parts": {"patches": 100},
    "compute": {"executor": "sync"},
}


def tree(output: Path, who: int, motion: str, connectivity: str, narrowings: bool = True) -> KinematicTree:
    synth = {
        "figure": f"adult:{who}", "motion": motion, "seed": who, "fps": 10, "frames": 8, "vertices": 1500,
        "connectivity": connectivity,
    }  # fmt: skip
    told = {"output": str(output), **SMALL, "source": {"synth": synth}, "kinematic_tree": {"narrowings": narrowings}}
    pipeline = Pipeline.of(told)
    assert pipeline.run(until=["kinematic_tree"])["status"] == "done"
    return pipeline.artifact(KinematicTree)


def test_wrists_that_no_motion_shows_are_joints_unless_the_setting_says_no(tmp_path: Path) -> None:
    without, body = (tree(tmp_path, 112, "walk", "new", has) for has in (False, True))
    assert without.narrowing_joints == ()
    assert len(body.narrowing_joints) == 2
    assert len(body.names) == len(without.names) + 2
    wrists = list(body.narrowing_joints)
    np.testing.assert_array_equal(body.degrees[wrists], 0.0)
    x = body.rest[wrists, 0] - body.rest[0, 0]
    assert x[0] * x[1] < 0.0, "one on either side"


def test_where_the_frames_give_every_vertex_no_narrowing_is_a_joint(tmp_path: Path) -> None:
    """One who looks around turns no ankle, and in so few frames shows no wrist."""
    found = {connectivity: tree(tmp_path, 2, "look", connectivity).narrowing_joints for connectivity in ("new", "fixed")}
    assert len(found["new"]) >= 2
    assert found["fixed"] == ()
