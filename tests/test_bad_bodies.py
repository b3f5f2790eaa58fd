"""Bodies that are none, through the whole default graph: a result that says how far to believe it, or one rigid part."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure

Frames = Iterable[tuple[np.ndarray, np.ndarray]]
LIMB = (("hip", "trunk", 2, [1.2, 1.0]), ("knee", "hip", 6, [1.0, 0.9]), ("tip", "knee", 10, [0.9, 0.6]))


def body_and_remarks(folder: Path, frames: Frames) -> tuple[Skeleton, str]:
    """The skeleton of these meshes, and all that the run remarks."""
    (folder / "scans").mkdir()
    for t, (V, F) in enumerate(frames):
        trimesh.Trimesh(V, F, process=False).export(folder / "scans" / f"frame_{t}.ply")
    blocks = {"source": {"input": str(folder / "scans")}, "output": str(folder / "out"), "compute": {"executor": "sync"},
            "geodesics": {"bases": 40}, "deformation_graph": {"nodes": 150}}  # fmt: skip
    pipeline = Pipeline.of(blocks)
    run = pipeline.run(until=["skeleton", "frame_confidence"])
    assert run["failures"] == []
    body: Any = pipeline.artifact("skeleton")
    assert np.isfinite(body.positions).all()
    assert ((body.confidence >= 0) & (body.confidence <= 1)).all()
    return body, "\n".join(text for _, text in pipeline.remarks())


def limbs(*ends: tuple[float, float], turns: dict[str, float], count: int = 5, **options: Any) -> Frames:
    """A trunk with two-boned limbs in these directions, of which the named joints turn by so many degrees."""
    joints: list[dict[str, Any]] = [{"name": "trunk", "position": [0, 0, 0], "radius": 2.0}]
    for k, (x, y) in enumerate(ends):
        for name, parent, at, radii in LIMB:
            above = parent if parent == "trunk" else f"{parent}_{k}"
            joints.append({"name": f"{name}_{k}", "parent": above, "position": [at * x, at * y, 0.0], "radii": radii})
    curves = {name: [{"axis": [0, 0, 1], "amplitude": degrees / 2, "frequency": 1.0}] for name, degrees in turns.items()}
    figure = Figure.of({"name": "body", "fps": 5, "joints": joints, "motions": {"m": curves}})
    body = Body.of(figure, frames=count, vertices=900, **options)
    return (body.frame(t) for t in range(count))


CROSS = ((1.0, 0.0), (-0.5, 0.87), (-0.5, -0.87))


def test_ring_is_one_rigid_part_and_the_run_speaks_of_its_loop(tmp_path: Path) -> None:
    rings = [trimesh.creation.torus(4.0, 1.0, major_sections=40 + t, minor_sections=14) for t in range(3)]
    body, remarks = body_and_remarks(tmp_path, [(ring.vertices + [0, t, 0], ring.faces) for t, ring in enumerate(rings)])
    assert "joint" not in body.kinds
    assert "the body is one rigid part" in remarks
    assert "has a loop" in remarks


@pytest.mark.parametrize("noise", [0.0, 0.001])
def test_body_that_does_not_move_is_one_rigid_part_and_the_run_says_so(tmp_path: Path, noise: float) -> None:
    body, remarks = body_and_remarks(tmp_path, limbs(*CROSS, turns={}, noise=noise))
    assert body.kinds.count("joint") == 0
    assert "no joints found: no part of the body turns against another, so the body is one rigid part" in remarks


def test_one_joint_that_turns_on_a_body_that_is_stiff_otherwise_is_the_only_one(tmp_path: Path) -> None:
    body, _ = body_and_remarks(tmp_path, limbs(*CROSS, turns={"knee_0": 40}))
    assert body.kinds.count("joint") == 1
    assert body.degrees.max() == pytest.approx(40, abs=8)


def test_body_with_one_limb_has_its_joint(tmp_path: Path) -> None:
    body, _ = body_and_remarks(tmp_path, limbs((1.0, 0.0), turns={"knee_0": 60}))
    assert body.kinds.count("joint") == 1


def test_limbs_never_seen_together_are_doubted_where_they_are_missing(tmp_path: Path) -> None:
    missing = [{"limb": "knee_0", "begin": 0, "end": 3}, {"limb": "knee_1", "begin": 4, "end": 7}]
    body, _ = body_and_remarks(tmp_path, limbs(*CROSS, turns={"knee_2": 60}, count=8, dropped=missing))
    assert body.kinds.count("joint") >= 1
    assert len(body.positions) == 8
    assert body.confidence.min() < 0.5 < body.confidence.max()
