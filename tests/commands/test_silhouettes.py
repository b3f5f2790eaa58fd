"""Rendered silhouettes are masks that a run reads back, all or nothing."""

import numpy as np
import pytest
import trimesh

from kinetree.errors import ConfigError
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.input.source import SourceParams
from kinetree.tasks.commands.silhouettes import silhouettes
from kinetree.tasks.input.frames.read import silhouettes as read_back
from kinetree.tasks.input.source import source


@pytest.fixture
def meshes(tmp_path):
    folder = tmp_path / "meshes"
    folder.mkdir()
    for t in range(3):
        ball = trimesh.creation.icosphere(subdivisions=2)
        ball.vertices = ball.vertices * [1, 2, 1] + [0, 0.2 * t, 0]
        ball.export(folder / f"{t}.ply")
    return folder


def test_masks_of_every_frame_hold_the_images_of_all_vertices_and_are_read_back(meshes, tmp_path):
    silhouettes(str(meshes), tmp_path / "masks", cameras=4, size=96)
    frames = source(SourceParams(input=str(tmp_path / "masks")), Files.of(Store.at(tmp_path / "store")))
    assert list(frames) == [0, 1, 2]
    for t, frame in frames.items():
        calibration, masks = read_back(frame)
        V = np.asarray(trimesh.load(meshes / f"{t}.ply", process=False).vertices)
        for P, mask in zip(calibration.P, masks, strict=True):
            image = V @ P[:, :3].T + P[:, 3]
            uv = image[:, :2] / image[:, 2:]
            assert mask is not None
            grown = np.pad(mask, 1)
            near = sum(grown[1 + dr : 97 + dr, 1 + dc : 97 + dc].astype(int) for dr in (-1, 0, 1) for dc in (-1, 0, 1)) > 0
            assert near[np.rint(uv[:, 1]).astype(int), np.rint(uv[:, 0]).astype(int)].all()
            assert not (mask[0] | mask[-1]).any()


def test_ring_goes_around_the_longest_side_or_the_one_that_is_named(meshes, tmp_path):
    for up, axis in ((None, 1), ("z", 2)):
        silhouettes(str(meshes), tmp_path / f"{up}", cameras=3, size=64, elevation=0.0, up=up, frames=":2")
        frame = source(SourceParams(input=str(tmp_path / f"{up}")), Files.of(Store.at(tmp_path / "store")))[0]
        calibration, _ = read_back(frame)
        centres = [-np.linalg.solve(P[:, :3], P[:, 3]) for P in calibration.P]
        assert np.ptp(centres, axis=0)[axis] < 1e-9


def test_what_cannot_be_is_refused_and_nothing_is_written(meshes, tmp_path):
    with pytest.raises(ConfigError, match="--up w: write x, y or z"):
        silhouettes(str(meshes), tmp_path / "masks", up="w", cameras=3, size=64, elevation=0.0, frames=":")
    with pytest.raises(ConfigError, match="^s3://walk/scans: masks are rendered from a folder or file of this machine"):
        silhouettes("s3://walk/scans", tmp_path / "masks", cameras=3, size=64)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "a").touch()
    with pytest.raises(ConfigError, match="not an empty folder"):
        silhouettes(str(meshes), tmp_path / "full", cameras=3, size=64)
    silhouettes(str(meshes), tmp_path / "masks", cameras=3, size=64)
    with pytest.raises(ConfigError, match="no meshes; silhouettes are rendered from a sequence of meshes"):
        silhouettes(str(tmp_path / "masks"), tmp_path / "again", cameras=3, size=64)
    assert not (tmp_path / "again").exists()
