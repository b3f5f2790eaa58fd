"""Surfaces of hulls and of volumes, from files to clean meshes; what changes when one file does."""

import nrrd
import numpy as np
import pytest
import trimesh
import zarr
from ball_views import CENTRE, RADIUS, write_folder

from kinetree.errors import HullError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.input.isosurface import IsosurfaceParams
from kinetree.schemas.input.source import SourceParams
from kinetree.tasks.input import INPUT
from kinetree.tasks.input.isosurface import isosurface
from kinetree.tasks.input.source import source
from kinetree.tasks.views.input import isosurface_remarks

GRAPHS = {"mesoscopic": Graph.of(INPUT)}
SHAPE = 22, 20, 30
POINTS = np.stack(np.meshgrid(*(np.arange(n) - 0.5 * (n - 1) for n in SHAPE), indexing="ij"), axis=-1)
AWAY = np.linalg.norm(POINTS, axis=-1) - 8.0


def volumes(folder, suffix, frames=3):
    folder.mkdir()
    stacked = np.stack([AWAY + 0.3 * t for t in range(frames)]).astype(np.float32)
    if suffix == "zarr":
        placed = {"voxel": 0.5, "origin": [1.0, 2.0, 3.0]}
        zarr.create_array(folder / "all.zarr", data=stacked, chunks=(1, *SHAPE), attributes=placed)
        return folder / "all.zarr"
    for t, values in enumerate(stacked):
        if suffix == "npz":
            np.savez(folder / f"volume_{t}.npz", field=values, origin=[1.0, 2.0, 3.0], voxel=0.5)
        elif suffix == "nrrd":
            nrrd.write(str(folder / f"{t}.nrrd"), values, {"spacings": [0.5, 0.5, 0.5]}, index_order="F")
        else:
            np.save(folder / f"{t}.npy", values)
    return folder


def pipeline(where, out, **blocks):
    compute = {"executor": "sync"}
    return Pipeline.of({"source": {"input": str(where)}, "output": str(out), "compute": compute, **blocks}, methods=GRAPHS)


@pytest.mark.parametrize(("suffix", "voxel"), [("npz", 0.5), ("nrrd", 0.5), ("npy", 1.0), ("zarr", 0.5)])
def test_a_run_takes_volumes_of_every_kind_to_clean_meshes(tmp_path, suffix, voxel):
    run = pipeline(volumes(tmp_path / "in", suffix), tmp_path / "out")
    summary = run.run()
    assert summary["failures"] == []
    mesh = run.artifact("mesh", frame=2)
    assert (mesh.cleaning.components, mesh.cleaning.boundary_edges, mesh.cleaning.euler) == (1, 0, 2)
    np.testing.assert_allclose(np.ptp(np.asarray(mesh.vertices), axis=0), 2 * voxel * 7.4, rtol=0.03)
    assert mesh.vertex_of_input.tolist() == list(range(len(mesh.vertices)))
    assert not [label for label in run.plan().by_label if label.startswith("hull")]


def test_a_run_takes_silhouettes_to_clean_meshes_and_replacing_one_mask_reruns_one_frame(tmp_path):
    walk = write_folder(tmp_path / "walk")
    run = pipeline(walk, tmp_path / "out", hull={"resolution": 32})
    assert run.run()["status"] == "done"
    assert (run.artifact("sequence").fps, run.artifact("sequence").unit) == (25.0, "m")
    mesh = trimesh.Trimesh(run.artifact("mesh", frame=1).vertices, run.artifact("mesh", frame=1).faces, process=False)
    assert mesh.is_watertight
    np.testing.assert_allclose(mesh.bounds.mean(axis=0), CENTRE + [0, 0, 0.1], atol=0.1)
    np.testing.assert_allclose(np.ptp(mesh.bounds, axis=0)[2], 2 * 0.9 * RADIUS, rtol=0.05)
    assert run.plan().is_done

    path = walk / "cam_05" / "frame_0001.png"
    path.write_bytes((walk / "cam_05" / "frame_0002.png").read_bytes())
    again = pipeline(walk, tmp_path / "out", hull={"resolution": 32})
    assert {task: row["ran"] for task, row in again.run()["tasks"].items()} == {
        "sequence": 1, "hull": 1, "isosurface": 1, "mesh": 1, "connectivity": 1,
    }  # fmt: skip


def test_volume_that_ends_before_the_body_is_closed_and_named(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    for t in range(2):
        np.save(folder / f"{t}.npy", AWAY[8:])
    frame = source(SourceParams(input=str(folder)), Files.of(Store.at(tmp_path / "store")))[0]
    surface = isosurface(frame, (), IsosurfaceParams())
    assert surface.cut > 0
    assert "reaches the border of its volume at" in isosurface_remarks(surface)[0]
    with pytest.raises(HullError, match=r"0.npy: all values of the volume lie on one side of the level 99"):
        isosurface(frame, (), IsosurfaceParams(level=99.0))
