"""Several takes of one body: one skeleton with the joints of all, from a body that stands elsewhere in every take."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from limbs import rotation

from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.input.synth import SynthParams
from kinetree.schemas.registration.tracking_order import TrackingOrder
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.input.frame_numbers import TAKE

FRAMES = 5


def written(folder: Path, motion: str, turn: float, shift: float) -> str:
    """A generated body in motion, turned and moved, as files."""
    generated = body(recipe(SynthParams(figure="human", motion=motion, frames=FRAMES, vertices=600)))
    folder.mkdir(parents=True)
    for t in range(FRAMES):
        V, F = generated.frame(t)
        trimesh.Trimesh(V @ rotation((0, 0, 1), turn).T + shift, F, process=False).export(folder / f"frame_{t}.ply")
    return str(folder)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Pipeline:
    """Two takes, computed."""
    folder = tmp_path_factory.mktemp("takes")
    takes = [
        {"name": "walk", "input": written(folder / "walk", "walk", 0.0, 0.0)},
        {"name": "wave", "input": written(folder / "wave", "wave", 1.2, 900.0)},
    ]
    small: dict[str, Any] = {
        "geodesics": {"bases": 40},
        "deformation_graph": {"nodes": 100},
        "rigid_parts": {"patches": 120},
        "compute": {"executor": "sync"},
    }
    pipeline = Pipeline.of({"source": {"takes": takes}, "output": str(folder / "out"), **small})
    told = pipeline.run(until=("skeleton_json", "bvh", "frame_confidence"))
    assert told["status"] == "done"
    return pipeline


@pytest.mark.parametrize("format_", ["trc", "c3d", "usd", "tables"])
def test_formats_on_request_have_files_of_every_take(run: Pipeline, format_: str) -> None:
    if format_ == "c3d":
        pytest.importorskip("ezc3d", reason="ezc3d writes C3D")
    exported = run.computed(format_).artifact(format_)
    walk, wave = (sorted(n for n in exported.names if f"-{take}." in n) for take in ("walk", "wave"))
    assert [name.replace("-walk.", "-wave.") for name in walk] == wave
    assert sorted(exported.names) == sorted(walk + wave)
    assert exported.content.size < 2**20, "no empty frames between the takes"


def test_one_skeleton_has_the_frames_of_all_takes(run: Pipeline) -> None:
    skeleton = run.artifact(Skeleton)
    assert skeleton.frames == (*range(FRAMES), *range(TAKE, TAKE + FRAMES))
    output = Path(run.config.output)
    walk, wave = (json.loads((output / f"skeleton-{name}.json").read_text()) for name in ("walk", "wave"))
    assert walk["bones"] == wave["bones"]
    assert walk["joints"] == wave["joints"]
    assert (output / "skeleton-wave.bvh").exists()


def test_no_interval_and_no_neighbour_reaches_across_a_border(run: Pipeline) -> None:
    cuts = run.artifact(Intervals)
    assert FRAMES in cuts.begin.tolist()
    order = run.artifact(TrackingOrder)
    across = [t for t in order.frames if (b := order.previous(t)) is not None and b // TAKE != t // TAKE]
    assert len(across) == 1


def test_the_body_is_found_where_it_stands_in_every_take(run: Pipeline) -> None:
    confidence = run.artifact("frame_confidence")
    assert confidence.residual.max() < 0.02  # type: ignore[attr-defined]
    skeleton = run.artifact(Skeleton)
    for t in (0, TAKE):
        vertices = np.array(run.artifact("mesh", frame=t).vertices)  # type: ignore[attr-defined]
        root = skeleton.positions[skeleton.frames.index(t), 0]
        assert np.linalg.norm(root - vertices.mean(axis=0)) < 0.2 * np.ptp(vertices, axis=0).max()
