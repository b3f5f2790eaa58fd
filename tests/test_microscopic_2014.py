"""Step II of the 2014 paper from end to end: from a body to meshes of one connectivity in each interval."""

from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from kinetree.pipeline import Pipeline
from kinetree.pipeline.graph import Graph
from kinetree.tasks.input import INPUT
from kinetree.tasks.paper_2014.arap import arap
from kinetree.tasks.paper_2014.cut_correspondence import cut_correspondence
from kinetree.tasks.paper_2014.geodesic_coordinates import geodesic_coordinates
from kinetree.tasks.paper_2014.geodesic_mapping import geodesic_mapping
from kinetree.tasks.paper_2014.interval_reference import interval_reference
from kinetree.tasks.topology.correlation import correlation
from kinetree.tasks.topology.extrema import extrema
from kinetree.tasks.topology.geodesics import geodesics
from kinetree.tasks.topology.intervals import intervals
from kinetree.tasks.topology.leaves import leaves
from kinetree.tasks.topology.mu_histogram import mu_histogram

STEPS = Graph.of(
    (*INPUT, geodesics, mu_histogram, correlation, extrema, intervals, leaves, geodesic_coordinates,
     interval_reference, geodesic_mapping, arap, cut_correspondence)
)  # fmt: skip
TOUCH = {"limb": "hand_r", "target": "hip_r", "begin": 5, "end": 9}
HUMAN = {"figure": "human", "frames": 13, "vertices": 1000, "contacts": [TOUCH]}


def ran(output: Path, executor: str = "sync", **blocks: Any) -> Pipeline:
    given = {"method": "mesoscopic-2014", "output": str(output), "compute": {"executor": executor}, **blocks}
    pipeline = Pipeline.of(given, methods={"mesoscopic-2014": STEPS})
    assert pipeline.run()["status"] == "done"
    return pipeline


def artifact(pipeline: Pipeline, node: str, **index: int) -> Any:
    return pipeline.artifact(node, **index)


def written(tmp_path: Path, *meshes: trimesh.Trimesh) -> dict[str, Any]:
    (tmp_path / "scans").mkdir()
    for t, one in enumerate(meshes):
        one.export(tmp_path / "scans" / f"frame_{t}.ply")
    return {"input": str(tmp_path / "scans")}


def test_each_interval_has_one_mesh_that_follows_the_body_whoever_computes_it(tmp_path: Path) -> None:
    blocks: dict[str, Any] = {"source": {"synth": HUMAN}, "geodesics": {"bases": 30}}
    pipeline = ran(tmp_path / "one", **blocks)
    other = ran(tmp_path / "many", "threads", **blocks)
    cuts = artifact(pipeline, "intervals")
    assert len(cuts.begin) == 3
    for i in range(3):
        reference = artifact(pipeline, "interval_reference", interval=i)
        assert len(reference.leaf) == (5, 4, 5)[i]
        for t in reference.frames:
            here = artifact(pipeline, "arap", interval=i, frame=t)
            assert len(here.vertices) == len(reference.vertices)
            assert here.residual.mean() < 0.03 * reference.size
            assert here == artifact(other, "arap", interval=i, frame=t)
    across = artifact(pipeline, "cut_correspondence")
    assert across.surplus(0, at_end=True), "the hand on the hip has no leaf behind the cut"
    assert across == artifact(other, "cut_correspondence")
    assert pipeline.run()["tasks"]["arap"]["ran"] == 0


def test_ball_without_leaves_is_followed_by_nothing_and_the_run_says_so(tmp_path: Path) -> None:
    balls = [trimesh.creation.icosphere(subdivisions=2).apply_scale(1 + 0.1 * t) for t in range(2)]
    balls[1].faces = np.roll(balls[1].faces, 7, axis=0)
    pipeline = ran(tmp_path, source=written(tmp_path, *balls), geodesics={"bases": 20})
    assert (artifact(pipeline, "geodesic_mapping", interval=0, frame=1).image == -1).all()
    assert artifact(pipeline, "arap", interval=0, frame=1).uncovered > 0.9
    assert any("interval 0 has no leaf" in text for _, text in pipeline.remarks())


def test_tracked_vertices_pass_unchanged(tmp_path: Path) -> None:
    boxes = [trimesh.creation.box(extents=[1, 1, 4 + t]).subdivide().subdivide() for t in range(3)]
    pipeline = ran(tmp_path, source=written(tmp_path, *boxes), geodesics={"bases": 20})
    for t in range(3):
        here = artifact(pipeline, "arap", interval=0, frame=t)
        np.testing.assert_array_equal(here.vertices, artifact(pipeline, "mesh", frame=t).vertices)
        assert (here.confidence == 1.0).all()
